#include "prediction/arm_chain.hpp"

#include <algorithm>
#include <limits>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

// Rodrigues' formula, written out: this is where inverse kinematics spends its time.
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle) {
  const double s = std::sin(angle), c = std::cos(angle), k = 1 - c;
  const double x = axis.x(), y = axis.y(), z = axis.z();
  Eigen::Matrix3d R;
  R << c + k * x * x, k * x * y - s * z, k * x * z + s * y,  //
      k * x * y + s * z, c + k * y * y, k * y * z - s * x,   //
      k * x * z - s * y, k * y * z + s * x, c + k * z * z;
  return R;
}

std::size_t find_link(const UrdfRobot& robot, const std::string& name, const std::string& where) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].name == name) return i;
    names.push_back(robot.links[i].name);
  }
  throw InputError(where, "has no link " + in_quotes(name), did_you_mean(name, names));
}

// Joints from `base` down to `tip`, fixed ones too. Joint i moves link i + 1.
std::vector<std::size_t> joints_between(const UrdfRobot& robot, std::size_t base, std::size_t tip,
                                        const std::string& where) {
  std::vector<std::size_t> joints;
  for (std::size_t link = tip; link != base; link = static_cast<std::size_t>(robot.links[link].parent)) {
    if (link == 0)
      throw InputError(
          where,
          "link " + in_quotes(robot.links[tip].name) + " does not hang below link " + in_quotes(robot.links[base].name),
          "name a base on the way from the root to the tip");
    joints.push_back(link - 1);
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

ArmJoint arm_joint(const UrdfJoint& from, const Pose& T_base_joint, const std::string& file) {
  const std::string where = file + ": joint " + in_quotes(from.name);
  if (from.mimic)
    throw InputError(where, "follows another joint, but lies between base and tip", "choose a tip above it");
  if (from.lower == from.upper)
    throw InputError(where, "its limits leave it no way to move (both are " + std::to_string(from.lower) + ")",
                     "write its range, or make it a fixed joint");
  ArmJoint joint;
  joint.name = from.name;
  joint.slides = from.kind == UrdfJoint::Kind::sliding;
  joint.axis = (T_base_joint.linear() * from.axis).normalized();
  joint.point = T_base_joint.translation();
  joint.lower = from.lower;
  joint.upper = from.upper;
  joint.velocity_known = from.velocity > 0;
  joint.velocity = joint.velocity_known ? from.velocity : kAssumedVelocity;
  return joint;
}

}  // namespace

JointVector joints_of(std::span<const double> positions, std::span<const std::size_t> joints) noexcept {
  JointVector out(static_cast<Eigen::Index>(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i) out[static_cast<Eigen::Index>(i)] = positions[joints[i]];
  return out;
}

ArmChain::ArmChain(std::vector<ArmJoint> joints, const Pose& T_base_tip_at_zero, const std::string& where)
    : joints_(std::move(joints)), T_base_tip_at_zero_(T_base_tip_at_zero) {
  if (joints_.empty()) throw InputError(where, "has no moving joint between base and tip", "choose a tip that moves");
  if (joints_.size() > kMostArmJoints)
    throw InputError(where, "has " + std::to_string(joints_.size()) + " moving joints between base and tip",
                     "choose base and tip with at most " + std::to_string(kMostArmJoints) + " between them");
  if (!T_base_tip_at_zero.matrix().allFinite()) throw InputError(where, "its tip is nowhere", "write finite numbers");
  const auto n = static_cast<Eigen::Index>(joints_.size());
  lower_.resize(n), upper_.resize(n), middle_.resize(n);
  Eigen::Vector3d last = joints_.front().point;
  for (Eigen::Index i = 0; i < n; ++i) {
    const ArmJoint& joint = joints_[static_cast<std::size_t>(i)];
    const std::string at = where + ": joint " + in_quotes(joint.name);
    if (!joint.axis.allFinite() || !joint.point.allFinite())
      throw InputError(at, "its place is not finite", "write finite numbers");
    if (!(joint.lower < joint.upper)) throw InputError(at, "its limits leave it no way to move", "write its range");
    if (!(joint.velocity > 0)) throw InputError(at, "its largest velocity is not positive", "write it in rad/s");
    if (joint.slides && !(std::isfinite(joint.lower) && std::isfinite(joint.upper)))
      throw InputError(at, "slides without an end", "write its limits");
    lower_[i] = joint.lower;
    upper_[i] = joint.upper;
    const bool ends = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    middle_[i] = ends ? 0.5 * (joint.lower + joint.upper) : std::clamp(0.0, joint.lower, joint.upper);
    if (joint.slides) reach_ += std::max(std::abs(joint.lower), std::abs(joint.upper));
    reach_ += (joint.point - last).norm();
    last = joint.point;
  }
  reach_ += (T_base_tip_at_zero.translation() - last).norm();
}

Pose ArmChain::tip_pose(const JointVector& q) const noexcept {
  Pose T = Pose::Identity();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const ArmJoint& joint = joints_[i];
    const double at = q[static_cast<Eigen::Index>(i)];
    if (joint.slides) {
      T.translation() += T.linear() * (at * joint.axis);
      continue;
    }
    const Eigen::Vector3d point = T.linear() * joint.point + T.translation();
    T.linear() = (T.linear() * rotation_about(joint.axis, at)).eval();
    T.translation() = point - T.linear() * joint.point;
  }
  Pose T_base_tip;
  T_base_tip.linear().noalias() = T.linear() * T_base_tip_at_zero_.linear();
  T_base_tip.translation() = T.linear() * T_base_tip_at_zero_.translation() + T.translation();
  T_base_tip.makeAffine();
  return T_base_tip;
}

Pose ArmChain::tip_pose(const JointVector& q, TipChange& change) const noexcept {
  std::array<Eigen::Vector3d, kMostArmJoints> points;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const ArmJoint& joint = joints_[i];
    const double at = q[static_cast<Eigen::Index>(i)];
    const Eigen::Vector3d axis = R * joint.axis;
    if (joint.slides) {
      change[i] << axis, Eigen::Vector3d::Zero();
      t += at * axis;
      continue;
    }
    change[i] << Eigen::Vector3d::Zero(), axis;
    points[i] = R * joint.point + t;
    R = (R * rotation_about(joint.axis, at)).eval();
    t = points[i] - R * joint.point;
  }
  Pose T_base_tip;
  T_base_tip.linear().noalias() = R * T_base_tip_at_zero_.linear();
  T_base_tip.translation() = R * T_base_tip_at_zero_.translation() + t;
  T_base_tip.makeAffine();
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (!joints_[i].slides) change[i].head<3>() = change[i].tail<3>().cross(T_base_tip.translation() - points[i]);
  return T_base_tip;
}

bool ArmChain::within_limits(const JointVector& q, double tolerance) const noexcept {
  if (static_cast<std::size_t>(q.size()) != size()) return false;
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (!(q[i] >= lower_[i] - tolerance && q[i] <= upper_[i] + tolerance)) return false;
  return true;
}

ArmChain arm_chain(const UrdfRobot& robot, const std::string& tip, const std::string& base, const std::string& where) {
  const std::size_t first = base.empty() ? 0 : find_link(robot, base, where);
  Pose T = Pose::Identity();
  std::vector<ArmJoint> joints;
  for (const std::size_t j : joints_between(robot, first, find_link(robot, tip, where), where)) {
    if (robot.joints[j].loose)
      throw InputError(where + ": joint " + in_quotes(robot.joints[j].name),
                       "is floating or planar, but lies between base and tip: no drive tells where it stands",
                       "choose a base below it");
    T = T * robot.joints[j].T_parent_joint;
    if (robot.joints[j].kind != UrdfJoint::Kind::fixed) joints.push_back(arm_joint(robot.joints[j], T, where));
  }
  return ArmChain(std::move(joints), T, where);
}

ArmChain read_arm_chain(const std::filesystem::path& urdf, const std::string& tip, const std::string& base) {
  return arm_chain(read_urdf(urdf, urdf.parent_path(), UrdfShapes::none), tip, base, urdf.string());
}

Vector6 pose_difference(const Pose& now, const Pose& then) noexcept {
  const Eigen::Matrix3d R = then.linear() * now.linear().transpose();
  // The quaternion keeps its digits where the trace of R has lost them: near 0 and near half a turn.
  const Eigen::Quaterniond q(R);
  const double s = q.vec().norm(), sign = q.w() < 0 ? -1 : 1;
  const double factor = s > 1e-12 ? 2 * std::atan2(s, std::abs(q.w())) / s : 2;
  Vector6 step;
  step << then.translation() - now.translation(), sign * factor * q.vec();
  return step;
}

Pose pose_between(const Pose& from, const Pose& to, double share) noexcept {
  const Vector6 step = pose_difference(from, to);
  const Eigen::Vector3d turn = share * step.tail<3>();
  const double angle = turn.norm();
  Pose between = from;
  if (angle > 0) between.linear() = rotation_about(turn / angle, angle) * from.linear();
  between.translation() += share * step.head<3>();
  return between;
}

}  // namespace foresight
