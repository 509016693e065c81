#include "texture_gpu/lamp/still_shadows.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "texture_gpu/lamp/lamp.hpp"

namespace foresight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::VectorXd;

constexpr std::size_t kFewestNew = 200;  // points that another image has to show
constexpr std::size_t kAround = 80, kFewestAround = 8;
constexpr double kNear = 0.15;                  // share of the extent of what is seen: further away is another place
constexpr float kAlike = 0.95f;                 // cosine of normals
constexpr float kMostBrighter = 0.4f;           // logarithm: print, of whatever lamp
constexpr double kBorder = 0.05;                // of the lamp
constexpr int kWays = 4 * ShadowRays::kPacket;  // over which a point sees its surroundings

/// Of points in a box, 0 .. 1 along each side: in this order, those that follow each other lie close to each other
/// (Morton, "A computer oriented geodetic data base", 1966).
std::uint32_t morton(const Vector3f& at) {
  constexpr int kBits = 10;
  const Eigen::Array3i cell = (at.array() * ((1 << kBits) - 1)).cast<int>();
  std::uint32_t out = 0;
  for (int bit = kBits - 1; bit >= 0; --bit)
    for (const int c : cell) out = out << 1 | (static_cast<std::uint32_t>(c) >> bit & 1u);
  return out;
}

}  // namespace

StillShadows::StillShadows(const ShadowRays& rays, std::span<const Witness> witnesses,
                           const std::deque<LampRecord>& records, std::size_t most) {
  std::vector<bool> shown(witnesses.size());
  while (points_.size() + kFewestNew <= most) {
    const LampRecord* best = nullptr;
    std::size_t new_ones = kFewestNew;
    for (const LampRecord& record : records) {
      std::size_t count = 0;
      for (std::size_t i = 0; i < shown.size(); ++i) count += !shown[i] && record.knows(i);
      if (count >= new_ones) best = &record, new_ones = count;
    }
    if (!best) break;
    for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = shown[i] || best->knows(i);
    add(rays, witnesses, *best, most);
  }
  more_than_around_.resize(static_cast<Eigen::Index>(brighter_.size()), static_cast<Eigen::Index>(points_.size()));
  more_than_around_.setFromTriplets(entries_.begin(), entries_.end());
  entries_ = {};
  leave_out_corners();
}

void StillShadows::add(const ShadowRays& rays, std::span<const Witness> witnesses, const LampRecord& record,
                       std::size_t most) {
  const std::size_t first = points_.size();
  images_.push_back(rays.pose(record.T_world_node, std::vector<bool>(record.T_world_node.size(), true)));
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < witnesses.size() && points_.size() < most; ++i) {
    if (!record.knows(i)) continue;
    points_.push_back({witnesses[i], images_.size() - 1, record.value(i)});
    box.extend(witnesses[i].point);
  }
  const Vector3f sizes = box.sizes().cwiseMax(1e-6f);
  std::ranges::sort(std::span(points_).subspan(first), {},
                    [&](const Point& p) { return morton((p.witness.point - box.min()).cwiseQuotient(sizes)); });
  compare_with_around(first, static_cast<float>(kNear * box.diagonal().norm()));
}

/// Of the points from the `first` on, which are of one image, each with others that are not further away than `near`.
void StillShadows::compare_with_around(std::size_t first, float near) {
  std::vector<std::pair<float, std::size_t>> others;
  for (std::size_t i = first; i < points_.size(); ++i) {
    open_.push_back(open(points_[i], near));
    const Witness& here = points_[i].witness;
    others.clear();
    for (std::size_t k = first; k < points_.size(); ++k) {
      const Witness& there = points_[k].witness;
      const float away = (there.point - here.point).norm();
      if (there.node == here.node && away < near && there.normal.dot(here.normal) > kAlike)
        others.emplace_back(away, k);
    }
    const std::size_t count = std::min(others.size(), kAround);
    if (count < kFewestAround) continue;
    std::ranges::nth_element(others, others.begin() + static_cast<std::ptrdiff_t>(count - 1));
    const auto row = static_cast<int>(brighter_.size());
    entries_.emplace_back(row, static_cast<int>(i), 1);
    Vector3f mean = Vector3f::Zero();
    for (const auto& [away, k] : std::span(others).first(count)) {
      entries_.emplace_back(row, static_cast<int>(k), -1 / static_cast<double>(count));
      mean += points_[k].value / static_cast<float>(count);
    }
    brighter_.push_back((points_[i].value - mean).cwiseMax(-kMostBrighter).cwiseMin(kMostBrighter));
  }
}

void StillShadows::leave_out_corners() {
  more_open_ = more_than_around_ * VectorXd::Map(open_.data(), std::ssize(open_)).array().log().matrix();
  luma_.resize(std::ssize(brighter_));
  std::ranges::transform(brighter_, luma_.begin(), luma_of);
  more_open_.normalize();  // zeros stay zeros
  luma_ -= more_open_.dot(luma_) * more_open_;
}

/// Over ways that are spread as light from all around counts: by their cosines.
double StillShadows::open(const Point& point, double reach) const {
  static const Disc disc = spiral(kWays);
  const Vector3f &p = point.witness.point, &n = point.witness.normal, right = n.unitOrthogonal();
  Eigen::Matrix3f axes;
  axes << right, n.cross(right), n;
  const ShadowRays::Points from = p.replicate<1, ShadowRays::kPacket>();
  int hits = 0;
  for (int first = 0; first < kWays; first += ShadowRays::kPacket) {
    ShadowRays::Points way;
    way.topRows<2>() = disc.middleCols<ShadowRays::kPacket>(first);
    way.row(2) = (1 - way.topRows<2>().colwise().squaredNorm().array()).sqrt();
    const ShadowRays::Points to = (static_cast<float>(reach) * axes * way).colwise() + p;
    hits += std::popcount(images_[point.image].blocked(from, to, ShadowRays::kPacket, ShadowRays::kContact));
  }
  return 1 - static_cast<double>(hits) / (kWays + 1);
}

VectorXd StillShadows::hidden(const Vector3d& lamp, double radius, const Disc& disc) const {
  if (disc.cols() == 0) return hidden_from_point(lamp);
  VectorXd out(std::ssize(points_));
  std::ranges::transform(points_, out.begin(), [&](const Point& point) {
    const auto& [witness, image, value] = point;
    const Vector3d p = witness.point.cast<double>();
    const bool faces = witness.normal.cast<double>().dot(lamp - p) > 0;
    return faces ? hidden_share(images_[image], p, lamp, radius, disc, ShadowRays::kContact) : 1;
  });
  return out;
}

VectorXd StillShadows::hidden_from_point(const Vector3d& lamp) const {
  VectorXd out = VectorXd::Ones(std::ssize(points_));
  const Vector3f at = lamp.cast<float>();
  std::vector<std::size_t> asked;
  std::vector<Vector3f> from;
  for (std::size_t i = 0; i < points_.size();) {
    const std::size_t image = points_[i].image;
    asked.clear();
    from.clear();
    for (; i < points_.size() && points_[i].image == image; ++i) {
      const Witness& witness = points_[i].witness;
      if (witness.normal.dot(at - witness.point) <= 0) continue;
      asked.push_back(i);
      from.push_back(witness.point);
    }
    const std::vector<bool> blocked = images_[image].blocked(from, lamp, ShadowRays::kContact);
    for (std::size_t k = 0; k < asked.size(); ++k) out[static_cast<Eigen::Index>(asked[k])] = blocked[k] ? 1 : 0;
  }
  return out;
}

VectorXd StillShadows::more_hidden(const Vector3d& lamp, double radius, const Disc& disc) const {
  VectorXd more = more_than_around_ * hidden(lamp, radius, disc);
  more -= more_open_.dot(more) * more_open_;
  return more;
}

StillShadows::Cast StillShadows::cast(const Vector3d& lamp, double radius, const Disc& disc) const {
  Cast out{VectorXd(std::ssize(points_)), hidden(lamp, radius, disc), {}};
  std::ranges::transform(points_, out.facing.begin(), [&](const Point& point) {
    const Vector3d to_lamp = lamp - point.witness.point.cast<double>();
    return std::max(0.0, facing(point.witness.normal.cast<double>(), to_lamp));
  });
  const VectorXd more = more_than_around_ * out.hidden;
  for (Eigen::Index i = 0; i < more.size(); ++i)
    if (std::abs(more[i]) > kBorder) out.borders.push_back(i);
  return out;
}

Eigen::Array3d StillShadows::errors(const Cast& cast, double strength) const {
  const auto open = Eigen::ArrayXd::Map(open_.data(), std::ssize(open_));
  const VectorXd shade = (open + strength * cast.facing.array() * (1 - cast.hidden.array())).log() / kResponse;
  Eigen::Array3d out = Eigen::Array3d::Zero();
  for (const Eigen::Index i : cast.borders)
    out += (brighter_[static_cast<std::size_t>(i)].cast<double>().array() - more_than_around_.row(i).dot(shade)).abs();
  return out;
}

}  // namespace foresight
