#include <algorithm>
#include <cmath>

#include "calibration/camera/camera_calibration.hpp"
#include "common/rotation.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kLeastNoise = 0.05;        // px; corners without noise would hide what cannot be told apart
constexpr double kVagueFocalLength = 0.02;  // sigma over the focal length
constexpr double kVagueCentre = 0.05;       // sigma over the image's width
constexpr double kVagueRim = 0.02;          // 90 % of the uncertainty over the image, of its width
constexpr double kWellCovered = 0.4;        // of the image; a fish-eye has dark corners that no board reaches
constexpr double kParallel = 5 * M_PI / 180;

struct Tilts {
  double to_image = 0;     // largest angle between a board and the image plane
  double to_another = 0;   // largest angle between two boards
  double second_axis = 0;  // spread of the tilt about the axis that it varies least about
};

Tilts tilts(const std::vector<Pose>& T_camera_board) {
  Tilts result;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  std::vector<Eigen::Vector3d> normals;
  for (const Pose& T : T_camera_board) {
    Eigen::Vector3d normal = T.linear().col(2);
    if (normal.z() < 0) normal = -normal;
    for (const Eigen::Vector3d& other : normals)
      result.to_another = std::max(result.to_another, std::acos(std::clamp(normal.dot(other), -1.0, 1.0)));
    normals.push_back(normal);
    result.to_image = std::max(result.to_image, std::acos(std::clamp(normal.z(), -1.0, 1.0)));
    spread += normal.head<2>() * normal.head<2>().transpose() / static_cast<double>(T_camera_board.size());
  }
  result.second_axis = std::asin(std::min(1.0, principal_lengths(spread)[1]));
  return result;
}

double covered(const RigViews& views, std::size_t c) {
  Eigen::AlignedBox2d box;
  for (const RigView& view : views.views)
    for (const Corner& corner : view.corners[c]) box.extend(corner.pixel);
  return box.isEmpty() ? 0 : box.volume() / (static_cast<double>(views.width[c]) * views.height[c]);
}

std::string only_covered(const RigViews& views, std::size_t c) {
  return "the boards reach only " + readable(100 * covered(views, c), 0) + " % of the image";
}

Objection missing(const RigViews& views, std::size_t c, const Tilts& t) {
  if (t.to_image < kParallel)
    return {"all boards are parallel to the image, so that focal length and distance cannot be told apart",
            "tilt the board by 20 to 40 degrees"};
  if (t.to_another < kParallel)
    return {"all boards are parallel to each other",
            "turn the board about both axes by 20 to 40 degrees between views"};
  if (t.second_axis < kParallel / 2)
    return {"the board is tilted about one axis only", "tilt it about the other one too"};
  if (covered(views, c) < kWellCovered) return {only_covered(views, c), "bring the board closer, and to all sides"};
  return {"the views say too little", "take more, closer, and with tilts about both axes"};
}

}  // namespace

std::optional<Objection> missing_motion(const RigViews& views, const RigSolution& solution,
                                        const RigUncertainty& uncertainty) {
  const double scale = std::max(1.0, kLeastNoise / std::max(1e-12, solution.noise_px));
  for (int camera = 0; camera < views.cameras; ++camera) {
    const auto c = static_cast<std::size_t>(camera);
    const CameraModel& model = solution.rig.cameras[c];
    const LensParameters sigma = uncertainty.lens_sigma(camera);
    const double focal = scale * std::max(sigma[0] / model.lens[0], sigma[1] / model.lens[1]);
    const double centre = scale * std::max(sigma[2], sigma[3]) / model.width;
    const std::string whose = views.cameras == 2 ? "the " + camera_name(camera, 2) + " camera: " : "";
    if (uncertainty.usable() && focal < kVagueFocalLength && centre < kVagueCentre) {
      const double rim_px = scale * uncertainty.map(camera, std::nullopt, 8, 6).p90_px;
      if (covered(views, c) >= kWellCovered || !(rim_px > kVagueRim * model.width)) continue;
      return Objection{whose + only_covered(views, c) + ", and do not say how it is distorted beyond (+- " +
                           readable(rim_px, 0) + " px)",
                       "bring the board closer, and to all sides"};
    }
    std::vector<Pose> T_camera_board;
    for (std::size_t v = 0; v < views.views.size(); ++v)
      if (!views.views[v].corners[c].empty())
        T_camera_board.push_back(camera == 0 ? solution.T_left_board[v]
                                             : Pose(solution.rig.T_left_right.inverse() * solution.T_left_board[v]));
    Objection out = missing(views, c, tilts(T_camera_board));
    out.what = whose + out.what;
    if (uncertainty.usable() && std::isfinite(focal))
      out.what += " (focal length +- " + readable(100 * focal, 1) + " %)";
    return out;
  }
  return std::nullopt;
}

double lens_difference(const CameraModel& a, const CameraModel& b) {
  constexpr int kCols = 20, kRows = 15;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> rays;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kCols * kRows; ++i) {
    const Eigen::Vector2d pixel((a.width - 1.0) * (i % kCols) / (kCols - 1),
                                (a.height - 1.0) * (i / kCols) / (kRows - 1));
    const auto ra = unproject(a, pixel), rb = unproject(b, pixel);
    if (!ra || !rb) continue;
    rays.emplace_back(*ra, *rb);
    sum += *rb * ra->transpose();
  }
  const Eigen::Matrix3d R = nearest_rotation(sum);
  std::vector<double> differences;
  for (const auto& [ra, rb] : rays) {
    const auto there = project(b, R * ra), here = project(b, rb);
    if (there && here) differences.push_back((*there - *here).norm());
  }
  if (differences.empty()) return std::numeric_limits<double>::quiet_NaN();
  return median(std::move(differences));
}

}  // namespace foresight
