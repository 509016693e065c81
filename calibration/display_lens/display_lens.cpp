#include "calibration/display_lens/display_lens.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <Eigen/LU>
#include <algorithm>

#include "calibration/camera/lens_slopes.hpp"
#include "calibration/camera/minimise.hpp"
#include "calibration/camera/rigid_motion.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/lens.hpp"
#include "common/rotation.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewest = 12;      // points of a picture: three times those of an affine map
constexpr double kFlat = 0.01;           // shorter over longer side of a picture's points on the panel
constexpr double kLargestError = 0.005;  // of points left out, of the panel's width
constexpr double kHuber = 1.5;           // panel px
constexpr double kClearlyBetter = 0.97;  // a model with more parameters must win by this factor
constexpr double kFloor = 0.02;          // panel px; residuals below are no outliers

struct Ray {
  int picture;
  Eigen::Vector3d direction;  // eye camera
  Eigen::Vector2d panel;
};

struct Unknowns {
  LensParameters lens{};
  std::vector<MotionParameters> motions;  // T_display_camera
};

// Parameters: lens (16), the camera's turn (4, a quaternion), its position (3).
struct PanelResidual {
  Distortion model;
  Eigen::Vector3d direction;
  Eigen::Vector2d panel;
  double distance;  // of the virtual image; 0: infinity

  template <typename T>
  bool operator()(const T* lens, const T* turn, const T* position, T* residual) const {
    Eigen::Matrix<T, 3, 1> p = Eigen::Map<const Eigen::Quaternion<T>>(turn) * direction.cast<T>();
    if (distance > 0) {
      if (!(p.z() > T(1e-6))) return false;
      const Eigen::Map<const Eigen::Matrix<T, 3, 1>> eye(position);
      p = (eye + p * ((T(distance) - eye.z()) / p.z())).eval();
    }
    Eigen::Matrix<T, 2, 1> pixel;
    if (!project_by_slopes(model, lens, p, pixel)) return false;
    residual[0] = pixel.x() - panel.x();
    residual[1] = pixel.y() - panel.y();
    return true;
  }
};

class Solver {
 public:
  Solver(const std::vector<Ray>& rays, Distortion model, const DisplayLensOptions& options)
      : rays_(rays), model_(model), distance_(options.virtual_distance_m.value_or(0)) {}

  // `free`: indices of lens parameters; `poses`: whether motions are free too.
  std::unique_ptr<ceres::Problem> build(Unknowns& x, std::vector<int> free, bool poses) const {
    auto problem = std::make_unique<ceres::Problem>();
    for (const Ray& ray : rays_) {
      auto* motion = x.motions[static_cast<std::size_t>(ray.picture)].data();
      problem->AddResidualBlock(new ceres::AutoDiffCostFunction<PanelResidual, 2, kLensParameters, 4, 3>(
                                    new PanelResidual{model_, ray.direction, ray.panel, distance_}),
                                new ceres::HuberLoss(kHuber), x.lens.data(), motion, motion + 4);
    }
    std::vector<int> held;
    for (int i = 0; i < kLensParameters; ++i)
      if (std::find(free.begin(), free.end(), i) == free.end()) held.push_back(i);
    if (!held.empty()) problem->SetManifold(x.lens.data(), new ceres::SubsetManifold(kLensParameters, held));
    for (std::size_t i = 0; i < x.motions.size(); ++i) {
      double* motion = x.motions[i].data();
      if (!problem->HasParameterBlock(motion)) continue;
      problem->SetManifold(motion, new ceres::EigenQuaternionManifold());
      if (!poses) problem->SetParameterBlockConstant(motion);
      if (!poses || i == 0 || !(distance_ > 0)) problem->SetParameterBlockConstant(motion + 4);
    }
    return problem;
  }

  bool run(Unknowns& x, const std::vector<int>& free, bool poses) const {
    MinimiseOptions solver;
    solver.most_iterations = 200;
    return minimise(*build(x, free, poses), solver).usable;
  }

  std::vector<double> distances(const Unknowns& x, const std::vector<Ray>& rays) const {
    std::vector<double> out;
    for (const Ray& ray : rays) {
      double r[2];
      const PanelResidual residual{model_, ray.direction, ray.panel, distance_};
      const double* motion = x.motions[static_cast<std::size_t>(ray.picture)].data();
      out.push_back(residual(x.lens.data(), motion, motion + 4, r) ? std::hypot(r[0], r[1]) : INFINITY);
    }
    return out;
  }

 private:
  const std::vector<Ray>& rays_;
  Distortion model_;
  double distance_;
};

std::vector<Ray> rays_of(const std::vector<PanelPoint>& points, const CameraModel& eye_camera) {
  const Lens lens = to_lens(eye_camera);
  std::vector<Ray> rays;
  for (const PanelPoint& p : points)
    if (const auto direction = lens.unproject(p.camera_pixel)) rays.push_back({p.picture, *direction, p.panel_pixel});
  return rays;
}

// panel = A (x/z, y/z) + b over the rays of a picture.
Eigen::Matrix<double, 2, 3> affine_of(const std::vector<Ray>& rays, int picture) {
  std::vector<Ray> of_picture;
  for (const Ray& ray : rays)
    if (ray.picture == picture && ray.direction.z() > 0.2) of_picture.push_back(ray);
  const std::string name = "picture " + std::to_string(picture + 1);
  if (of_picture.size() < kFewest)
    throw InputError(name, "shows " + counted(of_picture.size(), "point") + " of the panel",
                     "take a picture that shows at least " + std::to_string(kFewest));
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Ray& ray : of_picture) centre += ray.panel / static_cast<double>(of_picture.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 2, 3> moment = Eigen::Matrix<double, 2, 3>::Zero();
  for (const Ray& ray : of_picture) {
    const Eigen::Vector3d on_plane = ray.direction / ray.direction.z();
    const Eigen::Vector2d off = ray.panel - centre;
    scatter += off * off.transpose();
    normal += on_plane * on_plane.transpose();
    moment += ray.panel * on_plane.transpose();
  }
  const Eigen::Vector2d extents = principal_lengths(scatter);
  if (extents[1] < kFlat * extents[0]) throw InputError(name, "its points lie on a line", "show a grid of points");
  const Eigen::Matrix<double, 2, 3> A = moment * normal.inverse();
  if (A.leftCols<2>().determinant() <= 0)
    throw InputError(name, "shows the panel mirrored", "mirror the pattern's columns, or the picture where optics do");
  return A;
}

// Rotation that takes the rays of a picture to where an undistorted display shows their points.
Eigen::Quaterniond turn_of(const std::vector<Ray>& rays, int picture, const LensParameters& lens) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Ray& ray : rays) {
    if (ray.picture != picture) continue;
    const Eigen::Vector3d d((ray.panel.x() - lens[2]) / lens[0], (ray.panel.y() - lens[3]) / lens[1], 1);
    sum += d.normalized() * ray.direction.transpose();
  }
  return Eigen::Quaterniond(nearest_rotation(sum));
}

Unknowns start_of(const std::vector<Ray>& rays, int pictures, const DisplayLensOptions& options) {
  Unknowns x;
  const Eigen::Matrix<double, 2, 3> A = affine_of(rays, 0);
  const double focal = std::sqrt(A.leftCols<2>().determinant());
  x.lens = {focal, focal, (options.panel_width - 1) / 2.0, (options.panel_height - 1) / 2.0};
  for (int i = 0; i < pictures; ++i) {
    affine_of(rays, i);
    const Eigen::Quaterniond q = turn_of(rays, i, x.lens);
    x.motions.push_back({q.x(), q.y(), q.z(), q.w(), 0, 0, 0});
  }
  return x;
}

// First scale and turns, then everything.
bool fit(const std::vector<Ray>& rays, Distortion model, const DisplayLensOptions& options, Unknowns& x) {
  const Solver solver(rays, model, options);
  std::vector<int> first{0, 1, 4};
  return solver.run(x, first, true) && solver.run(x, free_parameters(model), true);
}

// Each point once by a solve that has not seen it.
std::vector<double> held_out(const std::vector<Ray>& rays, Distortion model, const DisplayLensOptions& options,
                             const Unknowns& start) {
  std::vector<double> all;
  for (int fold = 0; fold < options.folds; ++fold) {
    std::vector<Ray> seen, left_out;
    for (std::size_t i = 0; i < rays.size(); ++i)
      (static_cast<int>(i * 7919 % 104729) % options.folds == fold ? left_out : seen).push_back(rays[i]);
    Unknowns x = start;
    if (!fit(seen, model, options, x)) return {INFINITY};
    for (const double d : Solver(seen, model, options).distances(x, left_out)) all.push_back(d);
  }
  return all;
}

std::vector<Ray> without_outliers(const std::vector<Ray>& rays, const std::vector<double>& distances, double sigmas) {
  const double limit = sigmas * std::max(kFloor, robust_sigma_of_lengths(distances));
  std::vector<Ray> kept;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (distances[i] <= limit) kept.push_back(rays[i]);
  return kept;
}

void fill_sigmas(const Solver& solver, Unknowns& x, Distortion model, DisplayLensSummary& summary) {
  const auto problem = solver.build(x, free_parameters(model), true);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = -1;
  ceres::Covariance covariance(options);
  double* lens = x.lens.data();
  double* motion = x.motions[0].data();
  const std::vector<std::pair<const double*, const double*>> blocks{{lens, lens}, {motion, motion}};
  Eigen::Matrix<double, kLensParameters, kLensParameters, Eigen::RowMajor> of_lens;
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> of_turn;
  if (!covariance.Compute(blocks, problem.get()) || !covariance.GetCovarianceBlock(lens, lens, of_lens.data()) ||
      !covariance.GetCovarianceBlock(motion, motion, of_turn.data())) {
    summary.verdict.object("the pictures do not determine the lens: its covariance cannot be computed",
                           "turn the eye camera for more pictures");
    return;
  }
  const double s = summary.rms_px / std::sqrt(2.0);
  summary.sigma_focal_px = s * std::sqrt(std::max(of_lens(0, 0), of_lens(1, 1)));
  summary.sigma_centre_px = s * std::sqrt(std::max(of_lens(2, 2), of_lens(3, 3)));
  summary.sigma_tilt_rad = 2 * s * std::sqrt(of_turn.trace());  // a quaternion holds half the angle
  if (summary.sigma_centre_px > 0.02 * summary.panel.width)
    summary.warnings.push_back("the centre is uncertain by " + readable(summary.sigma_centre_px, 1) +
                               " px: it and the camera's tilt are hard to tell apart; show more of the panel");
}

}  // namespace

DisplayLensSummary solve_display_lens(const std::vector<PanelPoint>& points, const CameraModel& eye_camera,
                                      const DisplayLensOptions& options) {
  int pictures = 0;
  for (const PanelPoint& p : points) pictures = std::max(pictures, p.picture + 1);
  if (!pictures) throw InputError("pictures", "show no point of the panel", "show the pattern and focus on it");
  std::vector<Ray> rays = rays_of(points, eye_camera);
  const Unknowns start = start_of(rays, pictures, options);
  DisplayLensSummary summary;
  double best = INFINITY;
  Distortion model = options.models.front();
  for (const Distortion candidate : options.models) {
    Unknowns x = start;
    if (!fit(rays, candidate, options, x)) continue;
    const auto kept =
        without_outliers(rays, Solver(rays, candidate, options).distances(x, rays), options.outlier_sigmas);
    const double score = root_mean_square(held_out(kept, candidate, options, x));
    summary.tried.emplace_back(candidate, score);
    if (score < kClearlyBetter * best) best = score, model = candidate;
  }
  if (!std::isfinite(best))
    throw RuntimeFailure("no lens model fits the panel's points", "check the eye camera's calibration and the pattern");
  Unknowns x = start;
  fit(rays, model, options, x);
  const std::size_t before = rays.size();
  rays = without_outliers(rays, Solver(rays, model, options).distances(x, rays), options.outlier_sigmas);
  fit(rays, model, options, x);
  const Solver solver(rays, model, options);
  summary.panel = {options.panel_width, options.panel_height, model, x.lens};
  for (const MotionParameters& motion : x.motions) summary.T_display_camera.push_back(to_pose(motion));
  summary.rms_px = root_mean_square(solver.distances(x, rays));
  const auto unseen = held_out(rays, model, options, x);
  summary.held_out_px = root_mean_square(unseen);
  summary.held_out_worst_px = *std::max_element(unseen.begin(), unseen.end());
  summary.points = static_cast<int>(rays.size());
  summary.rejected = static_cast<int>(before - rays.size());
  fill_sigmas(solver, x, model, summary);
  if (const double limit = kLargestError * summary.panel.width; !(summary.held_out_px < limit))
    summary.verdict.object("points that were left out lie " + readable(summary.held_out_px, 1) +
                               " px from where the lens has them; " + readable(limit, 1) + " px are the limit",
                           "check --pattern and the eye camera's calibration, and that the eye camera only turned");
  return summary;
}

CameraModel solve_colour(const std::vector<PanelPoint>& points, const CameraModel& eye_camera,
                         const DisplayLensSummary& base, const DisplayLensOptions& options) {
  const std::vector<Ray> rays = rays_of(points, eye_camera);
  Unknowns x;
  x.lens = base.panel.lens;
  for (const Pose& T : base.T_display_camera) x.motions.push_back(to_parameters(T));
  std::vector<int> free = free_parameters(base.panel.distortion);
  std::erase_if(free, [](int i) { return i == 2 || i == 3; });
  const Solver solver(rays, base.panel.distortion, options);
  if (!solver.run(x, free, false)) throw RuntimeFailure("the colour's lens does not converge", "check its points");
  return {base.panel.width, base.panel.height, base.panel.distortion, x.lens};
}

}  // namespace foresight
