#include "calibration/placement/placement.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <random>

#include "calibration/camera/minimise.hpp"
#include "calibration/camera/rigid_motion.hpp"
#include "common/error.hpp"
#include "common/rotation.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kVagueM = 0.1, kVagueRad = 0.05;  // of the model's place: no texture would fit it
constexpr double kCauchy = 2;                      // sigmas
constexpr double kFlat = 1e-3;                     // second over first singular value of points on a line
constexpr std::size_t kMostTriples = 4000;

struct Unit {
  double scale;
  const char* name;
};
constexpr std::array<Unit, 8> kUnits{{{0.001, "the model is in millimetres"},
                                      {0.01, "the model is in centimetres"},
                                      {0.0254, "the model is in inches"},
                                      {0.3048, "the model is in feet"},
                                      {1000, "the world points are in millimetres"},
                                      {100, "the world points are in centimetres"},
                                      {1 / 0.0254, "the world points are in inches"},
                                      {1 / 0.3048, "the world points are in feet"}}};

double sigma_of(const PointPair& p, const PlacementOptions& options) {
  return p.sigma_m > 0 ? p.sigma_m : options.sigma_m;
}

std::string millimetres(double metres) {
  return readable(1000 * metres, metres < 0.01 ? 1 : 0, " mm");
}

// Largest two extents of the points about their centre, largest first.
Eigen::Vector2d extents(const std::vector<PointPair>& points, Eigen::Vector3d PointPair::*side) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const PointPair& p : points) centre += p.*side / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const PointPair& p : points) scatter += (p.*side - centre) * (p.*side - centre).transpose();
  return principal_lengths(scatter).head<2>();
}

void require_shape(const std::vector<PointPair>& points, const PlacementOptions& options) {
  if (points.size() < 3)
    throw InputError("measured points", "there are " + std::to_string(points.size()),
                     "measure at least 4, spread over the model; 3 place it without any check");
  for (const PointPair& p : points)
    if (!p.p_model.allFinite() || !p.p_world.allFinite())
      throw InputError(p.name, "is not finite", "write decimal numbers");
  for (const auto side : {&PointPair::p_model, &PointPair::p_world}) {
    const Eigen::Vector2d e = extents(points, side);
    const char* where = side == &PointPair::p_model ? "points of the model" : "points of the world";
    if (!(e[0] > 0)) throw InputError(where, "all lie at one place", "measure points that are far apart");
    if (e[1] < std::max(kFlat * e[0], side == &PointPair::p_world ? 2 * options.sigma_m : 0))
      throw InputError(where, "lie on a line: the model could turn about it", "add a point well off the line");
  }
}

// World over model, robust against single wrong points.
double scale_of(const std::vector<PointPair>& points) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double model = (points[i].p_model - points[j].p_model).norm();
      if (model > 0) ratios.push_back((points[i].p_world - points[j].p_world).norm() / model);
    }
  return median(std::move(ratios));
}

void require_scale(double scale, const std::vector<PointPair>& points, const PlacementOptions& options) {
  const double spread = extents(points, &PointPair::p_world)[0] / std::sqrt(static_cast<double>(points.size()));
  const double tolerance = std::max(options.scale_tolerance, 4 * options.sigma_m / spread);
  if (std::abs(std::log(scale)) <= std::log1p(tolerance)) return;
  for (const Unit& unit : kUnits)
    if (std::abs(std::log(scale / unit.scale)) <= std::log1p(std::max(0.1, tolerance)))
      throw InputError(
          "measured points", "the world is " + readable(scale, 4) + " times the model",
          std::string("scale ") + readable(unit.scale, 4) + " suspected: " + unit.name + "; write all in metres");
  throw InputError("measured points", "the world is " + readable(scale, 3) + " times the model",
                   "give the model the size of the real thing; it is never scaled here");
}

Pose aligned(const std::vector<PointPair>& points, std::span<const std::size_t> chosen) {
  Eigen::Vector3d model = Eigen::Vector3d::Zero(), world = Eigen::Vector3d::Zero();
  for (const std::size_t i : chosen) {
    model += points[i].p_model / static_cast<double>(chosen.size());
    world += points[i].p_world / static_cast<double>(chosen.size());
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const std::size_t i : chosen) sum += (points[i].p_world - world) * (points[i].p_model - model).transpose();
  Pose T = Pose::Identity();
  T.linear() = nearest_rotation(sum);
  T.translation() = world - T.linear() * model;
  return T;
}

double cost_of(const Pose& T, const std::vector<PointPair>& points, const PlacementOptions& options) {
  double cost = 0;
  for (const PointPair& p : points) {
    const double d = (T * p.p_model - p.p_world).norm() / sigma_of(p, options);
    cost += kCauchy * kCauchy * std::log1p(d * d / (kCauchy * kCauchy));
  }
  return cost;
}

// The best pose of any three points; all triples where they are few, else a fixed choice of them.
Pose consensus(const std::vector<PointPair>& points, const PlacementOptions& options) {
  const std::size_t n = points.size();
  std::vector<std::array<std::size_t, 3>> triples;
  if (n * (n - 1) * (n - 2) / 6 <= kMostTriples) {
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < a; ++b)
        for (std::size_t c = 0; c < b; ++c) triples.push_back({a, b, c});
  } else {
    std::mt19937 random(1);
    for (std::size_t i = 0; i < kMostTriples; ++i) triples.push_back({random() % n, random() % n, random() % n});
  }
  std::vector<std::size_t> all(n);
  for (std::size_t i = 0; i < n; ++i) all[i] = i;
  Pose best = aligned(points, all);
  double least = cost_of(best, points, options);
  for (const auto& triple : triples) {
    const Pose T = aligned(points, triple);
    if (const double cost = cost_of(T, points, options); cost < least) least = cost, best = T;
  }
  return best;
}

// Parameters: T_world_model (7).
struct PointResidual {
  Eigen::Vector3d p_model, p_world;
  double sigma;

  template <typename T>
  bool operator()(const T* motion, T* residual) const {
    const Eigen::Matrix<T, 3, 1> p = p_model.cast<T>();
    Eigen::Map<Eigen::Matrix<T, 3, 1>> r(residual);
    r = (transform(motion, p) - p_world.cast<T>()) / T(sigma);
    return true;
  }
};

// Refines `T`; with `summary`, its covariance too.
Pose refine(const Pose& T, const std::vector<PointPair>& points, const PlacementOptions& options,
            PlacementSummary* summary) {
  // About the centre of the points, so that rotation and position hardly correlate.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const PointPair& p : points) centre += p.p_model / static_cast<double>(points.size());
  MotionParameters motion = to_parameters(T * Eigen::Translation3d(centre));
  ceres::Problem problem;
  for (const PointPair& p : points)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PointResidual, 3, 7>(
                                 new PointResidual{p.p_model - centre, p.p_world, sigma_of(p, options)}),
                             new ceres::CauchyLoss(kCauchy), motion.data());
  problem.SetManifold(motion.data(), motion_manifold());
  MinimiseOptions solver;
  solver.most_iterations = 50;
  solver.function_tolerance = 1e-12;
  minimise_or_throw(problem, solver, "the placement", "check the points");
  if (summary) {
    ceres::Covariance covariance(ceres::Covariance::Options{});
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> c;
    const std::vector<std::pair<const double*, const double*>> blocks{{motion.data(), motion.data()}};
    if (covariance.Compute(blocks, &problem) &&
        covariance.GetCovarianceBlockInTangentSpace(motion.data(), motion.data(), c.data())) {
      // The quaternion's tangent is half the angle.
      summary->sigma_rotation_rad = 2 * std::sqrt(c.topLeftCorner<3, 3>().trace());
      summary->sigma_position_m = std::sqrt(c.bottomRightCorner<3, 3>().trace());
    }
  }
  return to_pose(motion) * Eigen::Translation3d(-centre);
}

void refuse_misfits(const PlacementSummary& summary, const std::vector<PointPair>& points,
                    const PlacementOptions& options) {
  std::string bad;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (summary.residual_m[i] <= options.worst_sigmas * std::sqrt(3) * sigma_of(points[i], options)) continue;
    bad += (bad.empty() ? "" : ", ") + points[i].name + " is " + millimetres(summary.residual_m[i]) + " off";
    ++count;
  }
  if (!count) return;
  if (2 * count >= points.size())
    throw InputError("measured points", "they do not fit the model: " + bad,
                     "check that they are given in the same order, and that it is this model");
  throw InputError("measured points", bad,
                   "measure " + std::string(count > 1 ? "them" : "it") + " again, or leave " +
                       (count > 1 ? "them" : "it") + " out; scale is " + readable(summary.scale, 3));
}

void refuse_mirrored(const Pose& start, const std::vector<PointPair>& points, const PlacementOptions& options) {
  std::vector<PointPair> mirrored = points;
  for (PointPair& p : mirrored) p.p_model.x() = -p.p_model.x();
  const double as_is = cost_of(start, points, options);
  const double flipped = cost_of(consensus(mirrored, options), mirrored, options);
  const double doubt = 9 * static_cast<double>(points.size());  // three sigmas each
  if (as_is > doubt && flipped < as_is / 3)
    throw InputError("measured points", "the world is a mirror image of the model",
                     "check the signs of an axis: model and world must both be right-handed");
}

double leave_one_out(const PlacementSummary& summary, const std::vector<PointPair>& points,
                     const PlacementOptions& options) {
  if (points.size() < 4) return NAN;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<PointPair> rest = points;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    const Eigen::Vector2d e = extents(rest, &PointPair::p_model);
    if (e[1] < kFlat * e[0]) continue;  // the others lie on a line
    const Pose T = refine(summary.T_world_model, rest, options, nullptr);
    sum += (T * points[i].p_model - points[i].p_world).squaredNorm();
    ++count;
  }
  return count ? std::sqrt(sum / count) : NAN;
}

}  // namespace

PlacementSummary place_model(const std::vector<PointPair>& points, const PlacementOptions& options) {
  require_shape(points, options);
  PlacementSummary summary;
  summary.scale = scale_of(points);
  require_scale(summary.scale, points, options);
  const Pose start = consensus(points, options);
  refuse_mirrored(start, points, options);
  summary.T_world_model = refine(start, points, options, &summary);
  double squares = 0;
  for (const PointPair& p : points) {
    summary.residual_m.push_back((summary.T_world_model * p.p_model - p.p_world).norm());
    squares += summary.residual_m.back() * summary.residual_m.back();
  }
  summary.rms_m = std::sqrt(squares / static_cast<double>(points.size()));
  refuse_misfits(summary, points, options);
  summary.loo_m = leave_one_out(summary, points, options);
  if (points.size() == 3)
    summary.warnings.emplace_back("three points fit almost anything: measure a fourth to see whether they are right");
  if (!(summary.sigma_position_m < kVagueM && summary.sigma_rotation_rad < kVagueRad))
    summary.verdict.object("the model's place is uncertain by " + readable(1000 * summary.sigma_position_m, 0) +
                               " mm and " + readable(57.29578 * summary.sigma_rotation_rad, 1) + " degrees",
                           "measure more points, farther from each other");
  return summary;
}

}  // namespace foresight
