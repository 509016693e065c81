#include "prediction/sighting/edge_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calibration/camera/pose_solver.hpp"
#include "calibration/registration/projection_slope.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostPoints = 500;
constexpr double kHuberPx = 1;       // px
constexpr double kAcross = 0.8;      // cosine between an edge's slope and the way across the projected one
constexpr double kOn = 1.5;          // px: lies on the edge
constexpr double kEdgeAside = 1e-4;  // m along an edge, for its direction in the picture
constexpr double kRounds[] = {1, 1, 0.7, 0.5, 0.35, 0.35};  // of the reach
constexpr double kLeastReach = 1.5;                         // px

/// An edge that a picture shows near a projected one.
struct Match {
  const SeenBy* camera;
  Eigen::Vector3d p;        // thing's frame
  Eigen::Vector2d n, seen;  // unit, across; px
};

struct Projected {
  Eigen::Vector2d pixel, n;
};

std::optional<Projected> project(const SeenBy& camera, const Pose& T_camera_thing, const OutlinePoint& point) {
  const auto pixel = camera.lens->project(T_camera_thing * point.p);
  const auto aside = camera.lens->project(T_camera_thing * (point.p + kEdgeAside * point.along));
  if (!pixel || !aside) return std::nullopt;
  const Eigen::Vector2d along = *aside - *pixel;
  const double length = along.norm();
  if (!(length > 1e-6)) return std::nullopt;  // it points at the camera
  return Projected{*pixel, Eigen::Vector2d(-along.y(), along.x()) / length};
}

/// Where along n the nearest edge is that runs alike, px; the strength falls to both sides.
std::optional<double> nearest_edge(const EdgePicture& picture, const Projected& at, double reach) {
  const int steps = static_cast<int>(std::ceil(reach));
  double values[3] = {};
  std::optional<double> best;
  for (int i = -steps - 1; i <= steps + 1; ++i) {
    const Eigen::Vector2d slope = picture.slope(at.pixel + i * at.n);
    const double across = std::abs(slope.dot(at.n));
    values[0] = values[1];
    values[1] = values[2];
    values[2] = across > kAcross * slope.norm() ? across : 0;
    if (i <= -steps) continue;
    if (values[1] < EdgePicture::kLeastSlope || values[1] < values[0] || values[1] <= values[2]) continue;
    const double bend = values[0] - 2 * values[1] + values[2];
    const double fine = i - 1 + std::clamp(bend < 0 ? (values[0] - values[2]) / (2 * bend) : 0, -0.5, 0.5);
    if (std::abs(fine) <= reach && (!best || std::abs(fine) < std::abs(*best))) best = fine;
  }
  return best;
}

std::vector<Match> match(std::span<const SeenBy> cameras, const std::vector<VisiblePoint>& points,
                         const Pose& T_world_thing, double reach) {
  std::vector<Pose> T_camera_thing;
  for (const SeenBy& camera : cameras) T_camera_thing.push_back(camera.T_world_camera.inverse() * T_world_thing);
  std::vector<Match> out;
  for (const VisiblePoint& visible : points) {
    const SeenBy& camera = cameras[visible.camera];
    const auto at = project(camera, T_camera_thing[visible.camera], *visible.point);
    if (!at) continue;
    if (const auto offset = nearest_edge(*camera.picture, *at, reach))
      out.push_back({&camera, visible.point->p, at->n, at->pixel + *offset * at->n});
  }
  return out;
}

/// r of each match, as the solver asks for it.
struct MatchProblem {
  const std::vector<Match>& matches;

  bool operator()(const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) const {
    for (const Match& match : matches) {
      const Pose T_camera_thing = match.camera->T_world_camera.inverse() * at.T;
      const Eigen::Vector3d p_camera = T_camera_thing * match.p;
      const auto pixel = match.camera->lens->project(p_camera);
      if (!pixel) return false;
      const double r = match.n.dot(*pixel - match.seen), size = std::abs(r);
      sum.cost += size > kHuberPx ? kHuberPx * (size - kHuberPx / 2) : size * size / 2;
      if (!derivatives) continue;
      const auto slope = projection_slope(*match.camera->lens, p_camera);
      if (!slope) return false;
      const Eigen::RowVector3d by_place = match.n.transpose() * *slope * T_camera_thing.linear();
      Vector6d j;
      j << match.p.cross(by_place.transpose()), by_place.transpose();
      const double w = size > kHuberPx ? kHuberPx / size : 1;
      sum.H.noalias() += w * j * j.transpose();
      sum.g += w * r * j;
    }
    return true;
  }
};

double spread_of(const std::vector<Match>& matches, const Pose& T_world_thing, std::size_t& on) {
  double sum = 0;
  on = 0;
  for (const Match& match : matches) {
    const auto pixel = match.camera->lens->project(match.camera->T_world_camera.inverse() * T_world_thing * match.p);
    if (!pixel) continue;
    const double r = match.n.dot(*pixel - match.seen);
    if (std::abs(r) > kOn) continue;
    ++on;
    sum += r * r;
  }
  return on > 0 ? std::sqrt(sum / static_cast<double>(on)) : 0;
}

}  // namespace

Matrix6d StartSigma::information(const Pose& start) const {
  const Eigen::Matrix3d R = start.linear();
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = R.transpose() * turn.cwiseAbs2().cwiseInverse().asDiagonal() * R;
  out.bottomRightCorner<3, 3>() = R.transpose() * place.cwiseAbs2().cwiseInverse().asDiagonal() * R;
  return out;
}

std::vector<VisiblePoint> visible_points(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                         const Pose& T_world_thing, std::size_t most) {
  std::vector<VisiblePoint> out;
  const std::size_t all = shape.outline().size() * cameras.size();
  // Many are not visible, so that half as many again are asked.
  const double step = std::max(1.0, static_cast<double>(all) / (2.0 * static_cast<double>(most)));
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const SeenBy& camera = cameras[c];
    const Pose T_camera_thing = camera.T_world_camera.inverse() * T_world_thing;
    const Eigen::Vector3d eye = T_camera_thing.inverse().translation();
    for (double at = 0; at < static_cast<double>(shape.outline().size()); at += step) {
      const OutlinePoint& point = shape.outline()[static_cast<std::size_t>(at)];
      const Eigen::Vector3d to_eye = eye - point.p;
      const bool silhouette = point.side[0].dot(to_eye) * point.side[1].dot(to_eye) <= 0;
      if (!silhouette && !point.open) continue;  // inside of it, prints beside an edge look like the edge
      const Eigen::Vector3d p_camera = T_camera_thing * point.p;
      const auto pixel = camera.lens->project(p_camera);
      if (!pixel || pixel->x() < 2 || pixel->y() < 2 || pixel->x() > camera.lens->width() - 3 ||
          pixel->y() > camera.lens->height() - 3)
        continue;
      if (camera.front && camera.front->hidden(*pixel, p_camera.norm(), node)) continue;
      if (shape.hides(eye, point.p)) continue;
      if (out.size() < most * (c + 1)) out.push_back({c, &point});
    }
  }
  return out;
}

std::optional<EdgeFit> fit_edges(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                 const Pose& start, const EdgeFitOptions& options) {
  EdgeFit out;
  out.T_world_thing = start;
  PoseSolverOptions<0> solver;
  solver.base = start;
  solver.most_iterations = 3;
  solver.prior = options.start.information(start);
  std::vector<VisiblePoint> points;
  std::vector<Match> matches;
  for (std::size_t round = 0; round < std::size(kRounds); ++round) {
    if (round % 3 == 0) points = visible_points(shape, node, cameras, out.T_world_thing, kMostPoints);
    if (points.size() < options.fewest_points) return std::nullopt;
    matches = match(cameras, points, out.T_world_thing, std::max(kLeastReach, kRounds[round] * options.reach_px));
    if (matches.size() < options.fewest_points) return std::nullopt;
    const auto solution = solve_pose<0>({out.T_world_thing, {}}, MatchProblem{matches}, solver);
    if (!solution.usable || !solution.at.T.matrix().allFinite()) return std::nullopt;
    out.T_world_thing = solution.at.T;
  }
  points = visible_points(shape, node, cameras, out.T_world_thing, kMostPoints);
  if (points.size() < options.fewest_points) return std::nullopt;
  matches = match(cameras, points, out.T_world_thing, kLeastReach);
  std::size_t on = 0;
  const double spread = std::max(options.edge_px, spread_of(matches, out.T_world_thing, on));
  out.points = points.size();
  out.agreement = static_cast<double>(on) / static_cast<double>(points.size());
  PoseEquations<0> equations;
  if (!MatchProblem{matches}({out.T_world_thing, {}}, true, equations)) return std::nullopt;
  out.covariance = (equations.H / (spread * spread * options.alike) + solver.prior).inverse();
  return out;
}

}  // namespace foresight
