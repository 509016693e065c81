#include "calibration/camera/corner_residual.hpp"

#include "calibration/camera/lens_slopes.hpp"
#include "calibration/camera/rigid_motion.hpp"
#include "common/rotation.hpp"

namespace foresight {
namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4>;
using Rows7 = Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>;
using Matrix37 = Eigen::Matrix<double, 3, 7>;

// Derivative of q * p after x y z w of q, for q p = p + w u + v x u, u = 2 v x p.
Matrix34 rotated_after_quaternion(const Eigen::Vector3d& v, double w, const Eigen::Vector3d& p) {
  const Eigen::Vector3d u = 2 * v.cross(p);
  Matrix34 d;
  d.leftCols<3>() = -2 * w * cross_matrix(p) - cross_matrix(u) - 2 * cross_matrix(v) * cross_matrix(p);
  d.col(3) = u;
  return d;
}

// Only the lens is left to automatic differentiation; the rigid motions are short by hand and
// make an evaluation three times as fast.
class CornerCost final : public ceres::CostFunction {
 public:
  explicit CornerCost(const CornerResidual& residual) : r_(residual) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {kLensParameters, 7, 2};
    if (r_.right) mutable_parameter_block_sizes()->push_back(7);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* T_left_board = parameters[1];
    Eigen::Vector3d p = r_.p_board;
    p.z() += r_.warp.x() * parameters[2][0] + r_.warp.y() * parameters[2][1];
    const Eigen::Vector3d p_left = transform(T_left_board, p);
    const Eigen::Vector3d p_camera = r_.right ? inverse_transform(parameters[3], p_left) : p_left;
    if (!jacobians) {
      Eigen::Vector2d pixel;
      if (!project(r_.distortion, parameters[0], p_camera, pixel)) return false;
      for (int row = 0; row < 2; ++row) residuals[row] = r_.weight * (pixel[row] - r_.pixel[row]);
      return true;
    }
    Eigen::Matrix<double, 2, 3> after_point;
    if (!project_with_derivatives(parameters[0], p_camera, residuals, jacobians[0], after_point)) return false;
    const Eigen::Map<const Eigen::Quaterniond> q_left_board(T_left_board);
    Eigen::Matrix<double, 2, 3> after_left = after_point;
    if (r_.right) {
      const Eigen::Map<const Eigen::Quaterniond> q(parameters[3]);
      const Eigen::Matrix3d R_right_left = q.toRotationMatrix().transpose();
      after_left = after_point * R_right_left;
      if (jacobians[3]) {
        const Eigen::Vector3d moved = p_left - Eigen::Map<const Eigen::Vector3d>(parameters[3] + 4);
        Matrix37 d;  // of the conjugate's rotation: the signs of x y z turn
        d.leftCols<4>() = rotated_after_quaternion(-q.vec(), q.w(), moved);
        d.leftCols<3>() *= -1;
        d.rightCols<3>() = -R_right_left;
        Rows7 rows(jacobians[3]);
        rows = after_point * d;
      }
    }
    if (jacobians[1]) {
      Matrix37 d;
      d.leftCols<4>() = rotated_after_quaternion(q_left_board.vec(), q_left_board.w(), p);
      d.rightCols<3>().setIdentity();
      Rows7 rows(jacobians[1]);
      rows = after_left * d;
    }
    if (jacobians[2]) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> rows(jacobians[2]);
      rows = after_left * (q_left_board * Eigen::Vector3d::UnitZ()) * r_.warp.transpose();
    }
    return true;
  }

 private:
  bool project_with_derivatives(const double* lens_values, const Eigen::Vector3d& p_values, double* residuals,
                                double* after_lens, Eigen::Matrix<double, 2, 3>& after_point) const {
    Eigen::Vector2d pixel;
    LensSlopes slopes;
    if (!project_with_slopes(r_.distortion, lens_values, p_values, pixel, slopes)) return false;
    Eigen::Map<Eigen::Vector2d> r(residuals);
    r = r_.weight * (pixel - r_.pixel);
    after_point = r_.weight * slopes.point;
    if (after_lens)
      Eigen::Map<Eigen::Matrix<double, 2, kLensParameters, Eigen::RowMajor>>{after_lens} = r_.weight * slopes.lens;
    return true;
  }

  CornerResidual r_;
};

}  // namespace

ceres::CostFunction* corner_cost(const CornerResidual& residual) {
  return new CornerCost(residual);
}

}  // namespace foresight
