#include "calibration/placement/tag_views.hpp"

#include <Eigen/Dense>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"

namespace foresight {
namespace {

constexpr double kVaguest = 0.1;  // m

struct WorldRay {
  Eigen::Vector3d origin, direction;
};

// Where the rays come nearest to each other; the second is the standard deviation of a coordinate.
std::pair<Eigen::Vector3d, double> meeting_point(const std::vector<WorldRay>& rays, double sigma_angle) {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int round = 0; round < 3; ++round) {  // the weight of a ray is its range, which the last round gives
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    information.setZero();
    for (const WorldRay& ray : rays) {
      const double range = round ? std::max(0.01, (p - ray.origin).norm()) : 1;
      const Eigen::Matrix3d across =
          (Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose()) / (range * range);
      information += across;
      sum += across * ray.origin;
    }
    p = information.ldlt().solve(sum);
  }
  return {p, sigma_angle * std::sqrt(information.inverse().trace() / 3)};
}

WorldRay world_ray(const SeenCorner& c, const std::map<std::string, Pose>& poses, const Lens& lens) {
  const auto pose = poses.find(c.image);
  if (pose == poses.end()) {
    std::vector<std::string> names;
    for (const auto& [name, T] : poses) names.push_back(name);
    throw InputError("--camera-poses", "has no row for the image " + in_quotes(c.image),
                     "add it; " + did_you_mean(c.image, names));
  }
  const auto direction = lens.unproject(c.pixel);
  if (!direction)
    throw InputError("--seen", "the lens sees nothing at tag " + std::to_string(c.tag) + " in " + in_quotes(c.image),
                     "give the camera that took the images");
  return {pose->second.translation(), pose->second.linear() * *direction};
}

}  // namespace

std::vector<SeenCorner> read_seen_corners(const std::filesystem::path& file) {
  std::vector<SeenCorner> out;
  for_each_row(file, "image id corner u v", [&](const TextRow& row) {
    const auto id = parse_integer(row.fields[1]), corner = parse_integer(row.fields[2]);
    const auto u = parse_number(row.fields[3]), v = parse_number(row.fields[4]);
    if (!id || *id < 0 || !corner || *corner < 0 || *corner > 3 || !u || !v || !std::isfinite(*u) || !std::isfinite(*v))
      throw InputError(row.where(), "is no tag corner in an image", "write 'image id corner u v', corners from 0 to 3");
    out.push_back({std::string(row.fields[0]), *id, *corner, {*u, *v}});
  });
  return out;
}

std::map<std::string, Pose> read_image_poses(const std::filesystem::path& file) {
  std::map<std::string, Pose> out;
  for_each_row(file, "image tx ty tz qx qy qz qw", [&](const TextRow& row) {
    if (!out.try_emplace(std::string(row.fields[0]), pose_fields(row, 1)).second)
      throw InputError(row.where(), "the image is named twice", "remove one row");
  });
  return out;
}

std::vector<PointPair> triangulate_tags(const std::filesystem::path& model, const std::vector<SeenCorner>& seen,
                                        const std::map<std::string, Pose>& poses, const Lens& lens, double sigma_px) {
  std::map<std::string, std::vector<WorldRay>> rays;
  for (const SeenCorner& c : seen) rays[tag_corner_name(c.tag, c.corner)].push_back(world_ray(c, poses, lens));
  std::vector<PointPair> points;
  for (PointPair pair : read_tag_corners(model)) {
    const auto found = rays.find(pair.name);
    if (found == rays.end() || found->second.size() < 2) continue;
    std::tie(pair.p_world, pair.sigma_m) = meeting_point(found->second, sigma_px / lens.parameters().fx);
    if (pair.p_world.allFinite() && pair.sigma_m < kVaguest) points.push_back(pair);
  }
  if (points.empty())
    throw InputError("--seen", "no tag of " + model.string() + " is seen from two places",
                     "add images from at least a tenth of the distance apart");
  return points;
}

}  // namespace foresight
