#include "calibration/camera/uncertainty.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/camera/lens_slopes.hpp"
#include "common/rotation.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

using Rows = Eigen::Matrix<double, 2, Eigen::Dynamic>;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Eigen::Matrix<double, 2, kLensParameters> after_lens(const CameraModel& camera, const Eigen::Vector3d& p_camera) {
  Eigen::Vector2d pixel;
  LensSlopes slopes;
  if (!project_with_slopes(camera.distortion, camera.lens.data(), p_camera, pixel, slopes)) slopes.lens.setZero();
  return slopes.lens;
}

}  // namespace

struct RigUncertainty::Impl {
  CameraRig rig;
  std::vector<Pose> T_left_board;
  RigInformation info;
  double noise_px = 0;
  Eigen::VectorXd scale;  // of each parameter, so that the matrix has a unit diagonal
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  bool usable = false;

  Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& rows) const {
    const Eigen::MatrixXd scaled = rows * scale.asDiagonal();
    const Eigen::MatrixXd solved = factor.solve(scaled.transpose());
    return noise_px * noise_px * (scaled * solved);
  }

  double sigma_of(int parameter) const {
    if (!usable) return kNone;
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, scale.size());
    row(0, parameter) = 1;
    return std::sqrt(covariance_of(row)(0, 0));
  }

  // How the pixel of a point that all boards carry moves with each parameter.
  Rows moves_of(int camera, const Eigen::Vector3d& p_camera, bool infinite) const {
    const CameraModel& model = rig.cameras[static_cast<std::size_t>(camera)];
    Eigen::Matrix<double, 2, 3> after_point;
    project(model, p_camera, &after_point);
    Rows rows = Rows::Zero(2, scale.size());
    const auto lens = after_lens(model, p_camera);
    const auto free = free_parameters(model.distortion);
    for (std::size_t i = 0; i < free.size(); ++i)
      rows.col(info.lens_at[static_cast<std::size_t>(camera)] + static_cast<int>(i)) = lens.col(free[i]);
    const double far = infinite ? 0 : 1;
    const Pose T_left_camera = camera == 1 ? rig.T_left_right : Pose::Identity();
    const Eigen::Matrix3d R = T_left_camera.linear();
    const Eigen::Vector3d turned = R * p_camera;  // about the right camera's centre
    const Eigen::Vector3d p_left = turned + far * T_left_camera.translation();
    const Eigen::Matrix<double, 2, 3> after_left = after_point * R.transpose();
    if (camera == 1) {
      rows.middleCols(info.motion_at, 3) = 2 * after_left * cross_matrix(turned);
      rows.middleCols(info.motion_at + 3, 3) = -far * after_left;
    }
    const double share = 1.0 / static_cast<double>(T_left_board.size());
    for (std::size_t v = 0; v < T_left_board.size(); ++v) {
      const int at = info.poses_at + 6 * static_cast<int>(v);
      const Eigen::Vector3d arm = p_left - far * T_left_board[v].translation();
      rows.middleCols(at, 3) = -2 * share * after_left * cross_matrix(arm);
      rows.middleCols(at + 3, 3) = far * share * after_left;
    }
    return rows;
  }
};

RigUncertainty::RigUncertainty(const RigViews& views, const RigSolution& solution, bool warp)
    : impl_(std::make_unique<Impl>()) {
  impl_->rig = solution.rig;
  impl_->T_left_board = solution.T_left_board;
  impl_->noise_px = solution.noise_px;
  impl_->info = rig_information(views, solution, warp);
  Eigen::SparseMatrix<double> matrix = impl_->info.matrix;
  impl_->scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  matrix = impl_->scale.asDiagonal() * matrix * impl_->scale.asDiagonal();
  impl_->factor.compute(matrix);
  constexpr double kSingular = 1e-13;  // of the diagonal: what rounding leaves of nothing
  impl_->usable = impl_->factor.info() == Eigen::Success && impl_->factor.vectorD().minCoeff() > kSingular;
}

RigUncertainty::~RigUncertainty() = default;
RigUncertainty::RigUncertainty(RigUncertainty&&) noexcept = default;
RigUncertainty& RigUncertainty::operator=(RigUncertainty&&) noexcept = default;

bool RigUncertainty::usable() const {
  return impl_->usable;
}

double RigUncertainty::at(int camera, const Eigen::Vector2d& pixel, std::optional<double> distance_m) const {
  if (!impl_->usable) return kNone;
  const auto ray = unproject(impl_->rig.cameras[static_cast<std::size_t>(camera)], pixel);
  if (!ray) return kNone;
  const Eigen::Vector3d p_camera = *ray * distance_m.value_or(1);
  const Eigen::Matrix2d covariance = impl_->covariance_of(impl_->moves_of(camera, p_camera, !distance_m));
  return principal_lengths(covariance)[0];
}

UncertaintyMap RigUncertainty::map(int camera, std::optional<double> distance_m, int cols, int rows) const {
  const CameraModel& model = impl_->rig.cameras[static_cast<std::size_t>(camera)];
  const double w = model.width - 1, h = model.height - 1;
  UncertaintyMap map;
  map.px.resize(rows, cols);
  std::vector<double> seen;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      map.px(row, col) = at(camera, {w * col / (cols - 1), h * row / (rows - 1)}, distance_m);
      if (std::isfinite(map.px(row, col))) seen.push_back(map.px(row, col));
    }
  map.centre_px = at(camera, {0.5 * w, 0.5 * h}, distance_m);
  map.median_px = seen.empty() ? kNone : median(seen);
  map.p90_px = seen.empty() ? kNone : quantile(seen, 0.9);
  map.worst_corner_px = kNone;
  for (const double corner : {map.px(0, 0), map.px(0, cols - 1), map.px(rows - 1, 0), map.px(rows - 1, cols - 1)})
    map.worst_corner_px = std::fmax(map.worst_corner_px, corner);
  return map;
}

LensParameters RigUncertainty::lens_sigma(int camera) const {
  LensParameters sigma{};
  const auto c = static_cast<std::size_t>(camera);
  const auto free = free_parameters(impl_->rig.cameras[c].distortion);
  for (std::size_t i = 0; i < free.size(); ++i)
    sigma[static_cast<std::size_t>(free[i])] = impl_->sigma_of(impl_->info.lens_at[c] + static_cast<int>(i));
  return sigma;
}

double RigUncertainty::baseline_sigma_m() const {
  if (!impl_->usable || impl_->info.motion_at < 0) return kNone;
  Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, impl_->scale.size());
  row.middleCols(impl_->info.motion_at + 3, 3) = impl_->rig.T_left_right.translation().normalized().transpose();
  return std::sqrt(impl_->covariance_of(row)(0, 0));
}

double RigUncertainty::rotation_sigma_rad() const {
  if (!impl_->usable || impl_->info.motion_at < 0) return kNone;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, impl_->scale.size());
  rows.middleCols(impl_->info.motion_at, 3) = 2 * Eigen::Matrix3d::Identity();
  const Eigen::MatrixXd covariance = impl_->covariance_of(rows);
  return principal_lengths(Eigen::Matrix3d(covariance))[0];
}

Eigen::Vector2d RigUncertainty::warp_sigma_m() const {
  if (impl_->info.warp_at < 0) return Eigen::Vector2d::Zero();
  return {impl_->sigma_of(impl_->info.warp_at), impl_->sigma_of(impl_->info.warp_at + 1)};
}

}  // namespace foresight
