#include "tests/prediction/sample_arms.hpp"

#include <limits>
#include <numbers>

#include "tests/support/folders.hpp"

namespace foresight {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d any_perpendicular(const Eigen::Vector3d& to, std::mt19937_64& random) {
  return to.cross(any_direction(random)).normalized();
}

}  // namespace

ArmChain lab_arm() {
  return read_arm_chain(source_folder() / "configs/arm.urdf", "arm_7");
}

double any_number(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Eigen::Vector3d any_direction(std::mt19937_64& random) {
  Eigen::Vector3d v;
  do v = {any_number(random, -1, 1), any_number(random, -1, 1), any_number(random, -1, 1)};
  while (v.norm() > 1 || v.norm() < 0.1);
  return v.normalized();
}

ArmChain any_spherical_arm(std::mt19937_64& random) {
  const Eigen::Vector3d S = any_direction(random), E = S + any_number(random, 0.2, 0.5) * any_direction(random),
                        W = E + any_number(random, 0.2, 0.5) * any_direction(random);
  std::vector<ArmJoint> joints(7);
  for (const std::size_t first : {0, 4}) {
    joints[first].axis = any_direction(random);
    joints[first + 1].axis = any_perpendicular(joints[first].axis, random);
    joints[first + 2].axis = any_perpendicular(joints[first + 1].axis, random);
    for (std::size_t i = first; i < first + 3; ++i)
      joints[i].point = (first == 0 ? S : W) + any_number(random, -0.3, 0.3) * joints[i].axis;
  }
  // Bends the arm, more or less in one plane.
  joints[3].axis = ((E - S).cross(W - E).normalized() + 0.3 * any_direction(random)).normalized();
  joints[3].point = E;
  for (ArmJoint& joint : joints) {
    joint.name = "j" + std::to_string(&joint - joints.data());
    joint.velocity = any_number(random, 0.5, 3);
    joint.lower = any_number(random, -3.5, -1);
    joint.upper = any_number(random, 1, 3.5);
    if (random() % 8 == 0) joint.upper = -(joint.lower = -std::numeric_limits<double>::infinity());
  }
  Pose tip = Pose::Identity();
  tip.linear() = Eigen::AngleAxisd(any_number(random, -kPi, kPi), any_direction(random)).toRotationMatrix();
  tip.translation() = W + any_number(random, 0, 0.3) * any_direction(random);
  return ArmChain(joints, tip, "arm");
}

ArmChain mirrored(const ArmChain& arm) {
  std::vector<ArmJoint> joints(arm.joints().begin(), arm.joints().end());
  const Eigen::Vector3d flip(1, -1, 1);
  for (ArmJoint& joint : joints) {
    joint.axis = -joint.axis.cwiseProduct(flip);  // an axis is no arrow but a turn
    joint.point = joint.point.cwiseProduct(flip);
  }
  Pose tip = arm.tip_at_zero();
  tip.linear() = flip.asDiagonal() * tip.linear() * flip.asDiagonal();
  tip.translation() = tip.translation().cwiseProduct(flip);
  return ArmChain(joints, tip, "mirrored arm");
}

JointVector any_joints(const ArmChain& arm, std::mt19937_64& random) {
  JointVector q(arm.lower().size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool ends = std::isfinite(arm.lower()[i]);
    q[i] = any_number(random, ends ? arm.lower()[i] : -kPi, ends ? arm.upper()[i] : kPi);
  }
  return q;
}

}  // namespace foresight
