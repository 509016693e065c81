#include "prediction/sighting/surface_colours.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calibration/camera/pose_solver.hpp"
#include "calibration/registration/projection_slope.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr int kLongest = 20;         // sightings that a colour is the mean of
constexpr std::size_t kFewest = 40;  // points that can be compared
constexpr double kBorder = 5;        // px
constexpr double kHuberLevels = 10;  // grey levels
constexpr double kLeastSpread = 4;   // grey levels, of |r|
constexpr double kAlike = 10;        // neighbouring points that err alike
constexpr double kMostOff = 60;      // grey levels

enum class Sight { away, covered, outside, seen };

Sight look_at(const ThingShape& shape, const SurfacePoint& point, std::size_t node, const SeenBy& camera,
              const Pose& T_camera_thing, const Eigen::Vector3d& eye, bool hiding) {
  if (shape.hides(eye, point.p)) return Sight::away;
  const Eigen::Vector3d p_camera = T_camera_thing * point.p;
  const auto at = camera.lens->project(p_camera);
  if (!at || at->x() < kBorder || at->y() < kBorder || at->x() > camera.lens->width() - 1 - kBorder ||
      at->y() > camera.lens->height() - 1 - kBorder)
    return Sight::outside;
  return hiding && camera.front && camera.front->hidden(*at, p_camera.norm(), node) ? Sight::covered : Sight::seen;
}

std::optional<Eigen::Vector3d> colour_at(const SeenBy& camera, std::size_t level, const Eigen::Vector3d& p_world) {
  const auto pixel = camera.lens->project(camera.T_world_camera.inverse() * p_world);
  return pixel ? camera.picture->colour(level, *pixel) : std::nullopt;
}

}  // namespace

std::vector<SurfaceView> surface_views(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                       const Pose& T_world_thing, bool hiding) {
  std::vector<SurfaceView> out;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const Pose T_camera_thing = cameras[c].T_world_camera.inverse() * T_world_thing;
    const Eigen::Vector3d eye = T_camera_thing.inverse().translation();
    for (std::size_t i = 0; i < shape.surface().size(); ++i)
      if (look_at(shape, shape.surface()[i], node, cameras[c], T_camera_thing, eye, hiding) == Sight::seen)
        out.push_back({c, i});
  }
  return out;
}

double uncovered_share(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                       const Pose& T_world_thing) {
  double best = 0;
  for (const SeenBy& camera : cameras) {
    const Pose T_camera_thing = camera.T_world_camera.inverse() * T_world_thing;
    const Eigen::Vector3d eye = T_camera_thing.inverse().translation();
    std::size_t towards = 0, seen = 0;
    for (const SurfacePoint& point : shape.surface()) {
      const Sight sight = look_at(shape, point, node, camera, T_camera_thing, eye, true);
      towards += sight != Sight::away ? 1 : 0;
      seen += sight == Sight::seen ? 1 : 0;
    }
    if (towards > 0) best = std::max(best, static_cast<double>(seen) / static_cast<double>(towards));
  }
  return best;
}

void SurfaceColours::learn(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                           const Pose& T_world_thing) {
  for (const SurfaceView& view : surface_views(shape, node, cameras, T_world_thing)) {
    const Eigen::Vector3d p_world = T_world_thing * shape.surface()[view.point].p;
    Colour& known = colours_[view.point];
    std::array<Eigen::Vector3d, EdgePicture::kLevels> seen;
    bool all = true;
    for (std::size_t level = 0; level < seen.size(); ++level) {
      const auto colour = colour_at(cameras[view.camera], level, p_world);
      all = all && colour;
      if (colour) seen[level] = *colour;
    }
    if (!all) continue;
    known.seen = std::min(known.seen + 1, kLongest);
    for (std::size_t level = 0; level < seen.size(); ++level)
      known.mean[level] += (seen[level] - known.mean[level]) / known.seen;
    known_ = true;
  }
}

std::vector<SurfaceView> SurfaceColours::known_views(const ThingShape& shape, std::size_t node,
                                                     std::span<const SeenBy> cameras, const Pose& T_world_thing) const {
  std::vector<SurfaceView> out = surface_views(shape, node, cameras, T_world_thing);
  std::erase_if(out, [&](const SurfaceView& view) { return !knows(view.point); });
  return out;
}

double SurfaceColours::gain(const ThingShape& shape, std::span<const SeenBy> cameras,
                            std::span<const SurfaceView> views, std::size_t level, const Pose& T_world_thing) const {
  std::vector<double> gains;
  for (const SurfaceView& view : views)
    if (const auto seen = colour_at(cameras[view.camera], level, T_world_thing * shape.surface()[view.point].p))
      gains.push_back(seen->sum() / std::max(3.0, colours_[view.point].mean[level].sum()));
  return gains.empty() ? 1 : std::clamp(median(std::move(gains)), 0.5, 2.0);
}

/// One level, as the solver asks for it.
struct SurfaceColours::Problem {
  const SurfaceColours& colours;
  const ThingShape& shape;
  std::span<const SeenBy> cameras;
  std::span<const SurfaceView> views;
  std::size_t level;
  double gain;

  bool operator()(const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) const {
    for (const SurfaceView& view : views) {
      const SeenBy& camera = cameras[view.camera];
      const Eigen::Vector3d& p = shape.surface()[view.point].p;
      const Pose T_camera_thing = camera.T_world_camera.inverse() * at.T;
      const Eigen::Vector3d p_camera = T_camera_thing * p;
      const auto pixel = camera.lens->project(p_camera);
      const auto seen = pixel ? camera.picture->colour(level, *pixel) : std::nullopt;
      if (!seen) {
        sum.cost += 3 * kHuberLevels * (2 * kHuberLevels);
        continue;
      }
      const Eigen::Vector3d r = *seen - gain * colours.colours_[view.point].mean[level];
      for (int c = 0; c < 3; ++c) {
        const double size = std::abs(r[c]);
        sum.cost += size > kHuberLevels ? kHuberLevels * (size - kHuberLevels / 2) : size * size / 2;
      }
      if (derivatives) add(camera, T_camera_thing, p, *pixel, r, sum);
    }
    return true;
  }

  void add(const SeenBy& camera, const Pose& T_camera_thing, const Eigen::Vector3d& p, const Eigen::Vector2d& pixel,
           const Eigen::Vector3d& r, PoseEquations<0>& sum) const {
    const auto slope = projection_slope(*camera.lens, T_camera_thing * p);
    if (!slope) return;
    Eigen::Matrix<double, 3, 2> of_picture;
    const double step = EdgePicture::kReach[level] / 2;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d d = step * Eigen::Vector2d::Unit(k);
      const auto after = camera.picture->colour(level, pixel + d), before = camera.picture->colour(level, pixel - d);
      if (!after || !before) return;
      of_picture.col(k) = (*after - *before) / (2 * step);
    }
    const Eigen::Matrix3d by_place = of_picture * *slope * T_camera_thing.linear();
    for (int c = 0; c < 3; ++c) {
      const double size = std::abs(r[c]), w = size > kHuberLevels ? kHuberLevels / size : 1;
      Vector6d j;
      j << p.cross(by_place.row(c).transpose()), by_place.row(c).transpose();
      sum.H.noalias() += w * j * j.transpose();
      sum.g += w * r[c] * j;
    }
  }
};

std::optional<ColourFit> SurfaceColours::fit(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                             const Pose& start, const StartSigma& sigma) const {
  ColourFit out;
  out.T_world_thing = start;
  PoseSolverOptions<0> solver;
  solver.base = start;
  solver.most_iterations = 8;
  const Matrix6d prior = sigma.information(start);
  PoseEquations<0> equations;
  std::vector<SurfaceView> views;
  for (std::size_t level = EdgePicture::kLevels; level-- > 0;) {
    views = known_views(shape, node, cameras, out.T_world_thing);
    if (views.size() < kFewest) return std::nullopt;
    const double g = gain(shape, cameras, views, level, out.T_world_thing);
    const Problem problem{*this, shape, cameras, views, level, g};
    // Residuals are in grey levels: information about the pose in their scale.
    solver.prior = kHuberLevels * kHuberLevels * kAlike * prior;
    const auto solution = solve_pose<0>({out.T_world_thing, {}}, problem, solver);
    if (!solution.usable || !solution.at.T.matrix().allFinite()) return std::nullopt;
    out.T_world_thing = solution.at.T;
    equations = {};
    if (level == 0) problem({out.T_world_thing, {}}, true, equations);
  }
  const auto off = difference(shape, cameras, views, out.T_world_thing);
  if (!off) return std::nullopt;
  out.difference = *off;
  out.points = views.size();
  const double spread = std::max(kLeastSpread, 1.5 * *off);
  out.covariance = (equations.H / (spread * spread * kAlike) + prior).inverse();
  return out;
}

std::optional<double> SurfaceColours::difference(const ThingShape& shape, std::size_t node,
                                                 std::span<const SeenBy> cameras, const Pose& T_world_thing) const {
  return difference(shape, cameras, known_views(shape, node, cameras, T_world_thing), T_world_thing);
}

std::optional<double> SurfaceColours::difference(const ThingShape& shape, std::span<const SeenBy> cameras,
                                                 std::span<const SurfaceView> views, const Pose& T_world_thing) const {
  if (views.size() < kFewest) return std::nullopt;
  const double g = gain(shape, cameras, views, 0, T_world_thing);
  std::vector<double> off;
  for (const SurfaceView& view : views)
    if (const auto seen = colour_at(cameras[view.camera], 0, T_world_thing * shape.surface()[view.point].p))
      off.push_back((*seen - g * colours_[view.point].mean[0]).cwiseAbs().mean());
  return off.empty() ? std::nullopt : std::optional(median(std::move(off)));
}

double SurfaceColours::coarse_difference(const ThingShape& shape, std::span<const SeenBy> cameras,
                                         std::span<const SurfaceView> views, const Pose& T_world_thing) const {
  double sum = 0;
  for (const SurfaceView& view : views) {
    const auto seen = colour_at(cameras[view.camera], 1, T_world_thing * shape.surface()[view.point].p);
    sum += seen ? std::min(kMostOff, (*seen - colours_[view.point].mean[1]).cwiseAbs().mean()) : kMostOff;
  }
  return views.empty() ? kMostOff : sum / static_cast<double>(views.size());
}

}  // namespace foresight
