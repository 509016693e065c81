#include "calibration/robot/motion_check.hpp"

#include <Eigen/Eigenvalues>

#include "calibration/robot/rigid_math.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kLeastTurn = 0.035;  // 2 degrees: below it, noise of the poses looks like a turn
constexpr double kDegree = 0.017453292519943295;

std::string axis_text(const Eigen::Vector3d& axis) {
  return "(" + readable(axis.x(), 2) + ", " + readable(axis.y(), 2) + ", " + readable(axis.z(), 2) + ")";
}

}  // namespace

MotionSpread motion_spread(std::span<const Pose> poses) {
  MotionSpread spread;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double pairs = 0;
  const std::size_t stride = std::max<std::size_t>(1, poses.size() / 60);
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    for (std::size_t j = i + stride; j < poses.size(); j += stride) {
      const Eigen::Vector3d turn = rotation_vector(poses[i].linear().transpose() * poses[j].linear());
      spread.largest_turn_rad = std::max(spread.largest_turn_rad, turn.norm());
      sum += turn * turn.transpose();
      ++pairs;
    }
  }
  if (pairs == 0) return spread;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sum / pairs);
  spread.second_axis_rad = std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
  spread.main_axis = eigen.eigenvectors().col(2);
  return spread;
}

void require_two_axes(const MotionSpread& spread, const std::string& where, const std::string& body) {
  if (spread.largest_turn_rad < kLeastTurn)
    throw InputError(where,
                     "the " + body + " turned by " + readable(spread.largest_turn_rad / kDegree, 1) +
                         " degrees at most; without turns all 3 translations of the hand-eye stay open",
                     "turn the " + body + " by 30 degrees and more about two axes");
  if (spread.second_axis_rad < std::max(kLeastTurn, 0.03 * spread.largest_turn_rad))
    throw InputError(
        where,
        "the " + body + " turned about one axis only, " + axis_text(spread.main_axis) +
            " in its own frame; 2 of 12 parameters stay open: the turn about that axis and the shift along it",
        "add poses that turn the " + body + " about another axis");
}

}  // namespace foresight
