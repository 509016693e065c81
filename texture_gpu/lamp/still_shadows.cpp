#include "texture_gpu/lamp/still_shadows.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "texture_gpu/lamp/lamp.hpp"

namespace foresight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kFewestNew = 200;  // points that another image has to show
constexpr std::size_t kAround = 80, kFewestAround = 8;
constexpr double kNear = 0.15;         // share of the extent of what is seen: further away is another place
constexpr float kAlike = 0.95f;        // cosine of normals
constexpr float kMostBrighter = 0.4f;  // logarithm: print, of whatever lamp
constexpr double kBorder = 0.05;       // of the lamp
constexpr std::size_t kWays = 4 * ShadowRays::kPacket;  // over which a point sees its surroundings

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
  const auto near = static_cast<float>(kNear * box.diagonal().norm());
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
    lists_.push_back({i, around_.size(), count});
    Vector3f mean = Vector3f::Zero();
    for (std::size_t k = 0; k < count; ++k) {
      around_.push_back(others[k].second);
      mean += points_[others[k].second].value / static_cast<float>(count);
    }
    brighter_.push_back((points_[i].value - mean).cwiseMax(-kMostBrighter).cwiseMin(kMostBrighter));
  }
}

void StillShadows::leave_out_corners() {
  std::vector<double> log_open;
  for (const double open : open_) log_open.push_back(std::log(open));
  const auto count = static_cast<Eigen::Index>(lists_.size());
  more_open_.resize(count);
  luma_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const List& list = lists_[static_cast<std::size_t>(i)];
    more_open_[i] = log_open[list.point] - around(list, log_open);
    luma_[i] = luma_of(brighter_[static_cast<std::size_t>(i)]);
  }
  more_open_.normalize();  // zeros stay zeros
  luma_ -= more_open_.dot(luma_) * more_open_;
}

/// Over ways that are spread as light from all around counts: by their cosines.
double StillShadows::open(const Point& point, double reach) const {
  static const Disc disc = spiral(kWays);
  const Vector3d p = point.witness.point.cast<double>(), n = point.witness.normal.cast<double>(),
                 right = n.unitOrthogonal(), up = n.cross(right);
  int hits = 0;
  std::array<Vector3d, ShadowRays::kPacket> to;
  for (std::size_t first = 0; first < disc.size(); first += to.size()) {
    for (std::size_t k = 0; k < to.size(); ++k) {
      const Eigen::Vector2d& at = disc[first + k];
      to[k] = p + reach * (at.x() * right + at.y() * up + std::sqrt(1 - at.squaredNorm()) * n);
    }
    hits += images_[point.image].count_blocked(p, to, ShadowRays::kContact);
  }
  return 1 - static_cast<double>(hits) / (kWays + 1);
}

double StillShadows::around(const List& list, const std::vector<double>& values) const {
  double sum = 0;
  for (std::size_t k = 0; k < list.count; ++k) sum += values[around_[list.first + k]];
  return sum / static_cast<double>(list.count);
}

std::vector<double> StillShadows::hidden(const Vector3d& lamp, double radius, const Disc& disc) const {
  std::vector<double> out;
  for (const auto& [witness, image, value] : points_) {
    const Vector3d p = witness.point.cast<double>();
    const bool faces = witness.normal.cast<double>().dot(lamp - p) > 0;
    out.push_back(faces ? hidden_share(images_[image], p, lamp, radius, disc, ShadowRays::kContact) : 1);
  }
  return out;
}

Eigen::VectorXd StillShadows::more_hidden(const Vector3d& lamp, double radius, const Disc& disc) const {
  const std::vector<double> values = hidden(lamp, radius, disc);
  Eigen::VectorXd more(luma_.size());
  for (Eigen::Index i = 0; i < more.size(); ++i) {
    const List& list = lists_[static_cast<std::size_t>(i)];
    more[i] = values[list.point] - around(list, values);
  }
  more -= more_open_.dot(more) * more_open_;
  return more;
}

StillShadows::Cast StillShadows::cast(const Vector3d& lamp, double radius, const Disc& disc) const {
  Cast out{{}, hidden(lamp, radius, disc), {}};
  for (const Point& point : points_) {
    const Vector3d l = lamp - point.witness.point.cast<double>();
    out.facing.push_back(std::max(0.0, point.witness.normal.cast<double>().dot(l) / std::pow(l.norm(), 3)));
  }
  for (std::size_t i = 0; i < lists_.size(); ++i)
    if (std::abs(out.hidden[lists_[i].point] - around(lists_[i], out.hidden)) > kBorder) out.borders.push_back(i);
  return out;
}

Eigen::Array3d StillShadows::errors(const Cast& cast, double strength) const {
  std::vector<double> shade;
  for (std::size_t i = 0; i < points_.size(); ++i)
    shade.push_back(std::log(open_[i] + strength * cast.facing[i] * (1 - cast.hidden[i])) / kResponse);
  Eigen::Array3d out = Eigen::Array3d::Zero();
  for (const std::size_t i : cast.borders)
    out += (brighter_[i].cast<double>().array() - (shade[lists_[i].point] - around(lists_[i], shade))).abs();
  return out;
}

}  // namespace foresight
