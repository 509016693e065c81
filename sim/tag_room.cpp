#include "sim/tag_room.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace foresight::sim {
namespace {

constexpr int kRaysAlong = 3;     // along each side of a pixel
constexpr double kFarAway = 1e9;  // metres
constexpr double kBits = 8;       // of a tag36h11 across its black border
constexpr double kBoardInk = 25, kBoardPaper = 225, kBoardTable = 120, kBoardWall = 150;

Pose on_table(double x, double y, double turn) {
  Pose T = Pose::Identity();
  T.translate(Eigen::Vector3d(x, y, 0));
  T.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  // Read from the head's side: right in print is -y of the world, down is -x.
  T.linear() *= (Eigen::Matrix3d() << 0, -1, 0, -1, 0, 0, 0, 0, -1).finished();
  return T;
}

Pose on_wall(double y, double z) {
  Pose T = Pose::Identity();
  T.translate(Eigen::Vector3d(0.6, y, z));
  T.linear() = (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
  return T;
}

}  // namespace

TagRoom::TagRoom(const std::vector<Tag>& tags) {
  for (const Tag& tag : tags) sheets_.push_back({tag, tag.T_world_tag.inverse(), tag_bits(tag.id)});
}

std::vector<TagRoom::Tag> TagRoom::lab_tags() {
  std::vector<Tag> tags;
  for (int i = 0; i < 9; ++i)
    tags.push_back({i, on_table(-0.35 + 0.28 * (i / 3), -0.36 + 0.36 * (i % 3) + 0.05 * (i / 3), 0.2 * (i - 4)), 0.08});
  for (int i = 0; i < 8; ++i) tags.push_back({20 + i, on_wall(-0.75 + 0.5 * (i % 4), 0.25 + 0.4 * (i / 4)), 0.12});
  return tags;
}

TagCorners TagRoom::corners() const {
  TagCorners out;
  for (const Sheet& sheet : sheets_) {
    const double s = sheet.tag.size_m / 2;
    const Pose& T = sheet.tag.T_world_tag;
    out[sheet.tag.id] = {T * Eigen::Vector3d(-s, s, 0), T * Eigen::Vector3d(s, s, 0), T * Eigen::Vector3d(s, -s, 0),
                         T * Eigen::Vector3d(-s, -s, 0)};
  }
  return out;
}

TagRoom::Place TagRoom::met(const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  const double to_table = d.z() < 0 ? -o.z() / d.z() : kFarAway, to_wall = d.x() > 0 ? (0.6 - o.x()) / d.x() : kFarAway;
  return {o + std::min(to_table, to_wall) * d, to_table < to_wall, std::min(to_table, to_wall) >= kFarAway};
}

double TagRoom::unprinted(const Place& place) {
  if (place.nowhere) return 90;
  const double a = place.on_table ? place.p.x() : place.p.z();
  return (place.on_table ? kBoardTable : kBoardWall) + 12 * std::sin(9 * a + 3 * std::sin(5 * place.p.y()));
}

bool TagRoom::is_near_a_tag(const Place& place, double within) const {
  return std::ranges::any_of(sheets_, [&](const Sheet& sheet) {
    return (place.p - sheet.tag.T_world_tag.translation()).norm() < sheet.tag.size_m + within;
  });
}

double TagRoom::grey(const Eigen::Vector3d& o, const Eigen::Vector3d& d) const {
  const Place place = met(o, d);
  if (place.nowhere) return unprinted(place);
  const Eigen::Vector3d& p = place.p;
  for (const Sheet& sheet : sheets_) {
    if ((p - sheet.tag.T_world_tag.translation()).squaredNorm() > sheet.tag.size_m * sheet.tag.size_m) continue;
    const Eigen::Vector3d at = sheet.T_tag_world * p;
    if (std::abs(at.z()) > 1e-6) continue;
    const double bit = sheet.tag.size_m / kBits, half = sheet.bits.cols / 2.0;
    const int u = static_cast<int>(std::floor(at.x() / bit + half)),
              v = static_cast<int>(std::floor(at.y() / bit + half));
    if (u >= 0 && v >= 0 && u < sheet.bits.cols && v < sheet.bits.rows)
      return sheet.bits.at<std::uint8_t>(v, u) ? kBoardPaper : kBoardInk;
  }
  return unprinted(place);
}

cv::Mat TagRoom::corner_rays(const Lens& lens) {
  cv::Mat rays(lens.height() + 1, lens.width() + 1, CV_64FC3);
  for (int v = 0; v < rays.rows; ++v)
    for (int u = 0; u < rays.cols; ++u) {
      const auto ray = lens.unproject({u - 0.5, v - 0.5});
      if (!ray) throw std::invalid_argument("TagRoom: the lens does not see all of its image");
      rays.at<cv::Vec3d>(v, u) = {ray->x(), ray->y(), ray->z()};
    }
  return rays;
}

cv::Mat TagRoom::picture(const cv::Mat& rays, const Pose& T_world_camera, double noise, unsigned seed) const {
  cv::Mat out(rays.rows - 1, rays.cols - 1, CV_8UC1);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, std::max(noise, 1e-9));
  const Eigen::Vector3d origin = T_world_camera.translation();
  const auto ray = [&](int u, int v) -> Eigen::Vector3d {
    return T_world_camera.linear() * Eigen::Map<const Eigen::Vector3d>(rays.at<cv::Vec3d>(v, u).val);
  };
  for (int v = 0; v < out.rows; ++v)
    for (int u = 0; u < out.cols; ++u) {
      // The lens is linear enough within a pixel.
      const Eigen::Vector3d a = ray(u, v), across = ray(u + 1, v) - a, down = ray(u, v + 1) - a;
      const Place middle = met(origin, a + 0.5 * across + 0.5 * down);
      double spread = 0;
      for (const auto& corner :
           {a, Eigen::Vector3d(a + across), Eigen::Vector3d(a + down), Eigen::Vector3d(a + across + down)})
        spread = std::max(spread, (met(origin, corner).p - middle.p).norm());
      if (!is_near_a_tag(middle, spread)) {  // table and wall change little within a pixel
        out.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(unprinted(middle) + normal(random));
        continue;
      }
      double sum = 0;
      for (int k = 0; k < kRaysAlong * kRaysAlong; ++k)
        sum +=
            grey(origin, a + (k % kRaysAlong + 0.5) / kRaysAlong * across + (k / kRaysAlong + 0.5) / kRaysAlong * down);
      out.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(sum / (kRaysAlong * kRaysAlong) + normal(random));
    }
  return out;
}

}  // namespace foresight::sim
