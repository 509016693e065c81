#include "prediction/arm_chain.hpp"

#include <algorithm>
#include <limits>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/urdf_limits.hpp"

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

// What drives the tip, by index in the URDF: joints on the way in their order, then those beside it that something on
// it follows.
std::vector<std::size_t> drives_of(const UrdfRobot& robot, std::span<const std::size_t> way) {
  std::vector<std::size_t> out;
  for (const std::size_t j : way)
    if (robot.joints[j].kind != UrdfJoint::Kind::fixed && !robot.joints[j].mimic) out.push_back(j);
  for (const std::size_t j : way) {
    const JointSource source = source_of(robot, j);
    const auto leader = static_cast<std::size_t>(source.joint);
    if (robot.joints[j].mimic && source.factor != 0 && std::ranges::find(out, leader) == out.end())
      out.push_back(leader);
  }
  return out;
}

ArmJoint arm_joint(const UrdfRobot& robot, std::size_t index, bool carries_tip, const std::string& file) {
  const UrdfJoint& own = robot.joints[index];
  const std::string where = file + ": joint " + in_quotes(own.name);
  if (own.lower == own.upper)
    throw InputError(where, "its limits leave it no way to move (both are " + std::to_string(own.lower) + ")",
                     "write its range, or make it a fixed joint");
  const UrdfJoint from = within_followers(robot, index);
  if (!(from.lower < from.upper))
    throw InputError(where, "the limits of the joints that follow it leave it no way to move",
                     "correct their <limit>, or multiplier and offset of their <mimic>");
  ArmJoint joint;
  joint.name = from.name;
  joint.slides = from.kind == UrdfJoint::Kind::sliding;
  joint.lower = from.lower;
  joint.upper = from.upper;
  joint.velocity_known = from.velocity > 0;
  joint.velocity = joint.velocity_known ? from.velocity : kAssumedVelocity;
  joint.carries_tip = carries_tip;
  return joint;
}

// From the base on: joints that carry the tip, and between them what follows any.
std::vector<ArmLine> lines_of(std::span<const ArmJoint> joints, std::span<const ArmFollower> followers) {
  std::vector<ArmLine> out;
  std::size_t next = 0;
  for (std::size_t i = 0; i <= joints.size(); ++i) {
    for (; next < followers.size() && (followers[next].after <= i || i == joints.size()); ++next) {
      const ArmFollower& f = followers[next];
      out.push_back({f.leader, f.factor, f.slides, f.axis, f.point});
    }
    if (i < joints.size() && joints[i].carries_tip)
      out.push_back({i, 1, joints[i].slides, joints[i].axis, joints[i].point});
  }
  return out;
}

}  // namespace

JointVector joints_of(std::span<const double> positions, std::span<const std::size_t> joints) noexcept {
  JointVector out(static_cast<Eigen::Index>(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i) out[static_cast<Eigen::Index>(i)] = positions[joints[i]];
  return out;
}

ArmChain::ArmChain(std::vector<ArmJoint> joints, const Pose& T_base_tip_at_zero, const std::string& where,
                   std::vector<ArmFollower> followers)
    : joints_(std::move(joints)),
      followers_(std::move(followers)),
      lines_(lines_of(joints_, followers_)),
      T_base_tip_at_zero_(T_base_tip_at_zero) {
  if (joints_.empty()) throw InputError(where, "has no moving joint between base and tip", "choose a tip that moves");
  if (joints_.size() > kMostArmJoints)
    throw InputError(where, "has " + std::to_string(joints_.size()) + " moving joints between base and tip",
                     "choose base and tip with at most " + std::to_string(kMostArmJoints) + " between them");
  if (!T_base_tip_at_zero.matrix().allFinite()) throw InputError(where, "its tip is nowhere", "write finite numbers");
  const auto n = static_cast<Eigen::Index>(joints_.size());
  lower_.resize(n), upper_.resize(n), middle_.resize(n);
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
  }
  require_lines(where);
  Eigen::Vector3d last = lines_.front().point;
  for (const ArmLine& line : lines_) {
    const ArmJoint& joint = joints_[line.joint];
    if (line.slides) reach_ += std::abs(line.factor) * std::max(std::abs(joint.lower), std::abs(joint.upper));
    reach_ += (line.point - last).norm();
    last = line.point;
  }
  reach_ += (T_base_tip_at_zero.translation() - last).norm();
}

void ArmChain::require_lines(const std::string& where) const {
  if (lines_.empty() || lines_.size() > kMostArmLines)
    throw InputError(where, "has " + std::to_string(lines_.size()) + " joints between base and tip that move it",
                     "choose base and tip with 1 to " + std::to_string(kMostArmLines) + " between them");
  for (const ArmFollower& follower : followers_) {
    if (follower.leader >= joints_.size())
      throw InputError(where, "a joint follows one that the arm lacks", "name one that it has");
    const ArmJoint& leader = joints_[follower.leader];
    const std::string at = where + ": what follows joint " + in_quotes(leader.name);
    if (!follower.axis.allFinite() || !follower.point.allFinite() || !std::isfinite(follower.factor))
      throw InputError(at, "its place or factor is not finite", "write finite numbers");
    if (follower.slides && !(std::isfinite(leader.lower) && std::isfinite(leader.upper)))
      throw InputError(at, "slides without an end", "write its limits");
  }
}

Pose ArmChain::tip_pose(const JointVector& q) const noexcept {
  Pose T = Pose::Identity();
  for (const ArmLine& line : lines_) {
    const double at = line.factor * q[static_cast<Eigen::Index>(line.joint)];
    if (line.slides) {
      T.translation() += T.linear() * (at * line.axis);
      continue;
    }
    const Eigen::Vector3d point = T.linear() * line.point + T.translation();
    T.linear() = (T.linear() * rotation_about(line.axis, at)).eval();
    T.translation() = point - T.linear() * line.point;
  }
  Pose T_base_tip;
  T_base_tip.linear().noalias() = T.linear() * T_base_tip_at_zero_.linear();
  T_base_tip.translation() = T.linear() * T_base_tip_at_zero_.translation() + T.translation();
  T_base_tip.makeAffine();
  return T_base_tip;
}

Pose ArmChain::tip_pose(const JointVector& q, LineChange& change) const noexcept {
  std::array<Eigen::Vector3d, kMostArmLines> points;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const ArmLine& line = lines_[i];
    const double at = line.factor * q[static_cast<Eigen::Index>(line.joint)];
    const Eigen::Vector3d axis = R * line.axis;
    if (line.slides) {
      change[i] << axis, Eigen::Vector3d::Zero();
      t += at * axis;
      continue;
    }
    change[i] << Eigen::Vector3d::Zero(), axis;
    points[i] = R * line.point + t;
    R = (R * rotation_about(line.axis, at)).eval();
    t = points[i] - R * line.point;
  }
  Pose T_base_tip;
  T_base_tip.linear().noalias() = R * T_base_tip_at_zero_.linear();
  T_base_tip.translation() = R * T_base_tip_at_zero_.translation() + t;
  T_base_tip.makeAffine();
  for (std::size_t i = 0; i < lines_.size(); ++i)
    if (!lines_[i].slides) change[i].head<3>() = change[i].tail<3>().cross(T_base_tip.translation() - points[i]);
  return T_base_tip;
}

Pose ArmChain::tip_pose(const JointVector& q, TipChange& change) const noexcept {
  LineChange by_line;
  const Pose T_base_tip = tip_pose(q, by_line);
  std::fill_n(change.begin(), joints_.size(), Vector6::Zero());
  for (std::size_t i = 0; i < lines_.size(); ++i) change[lines_[i].joint] += lines_[i].factor * by_line[i];
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
  const std::vector<std::size_t> way = joints_between(robot, first, find_link(robot, tip, where), where);
  const std::vector<std::size_t> drives = drives_of(robot, way);
  std::vector<ArmJoint> joints;
  for (const std::size_t j : drives)
    joints.push_back(arm_joint(robot, j, std::ranges::find(way, j) != way.end(), where));
  std::vector<ArmFollower> followers;
  std::size_t carried = 0;  // of the joints
  Pose T = Pose::Identity();
  for (const std::size_t j : way) {
    const UrdfJoint& joint = robot.joints[j];
    if (joint.loose)
      throw InputError(where + ": joint " + in_quotes(joint.name),
                       "is floating or planar, but lies between base and tip: no drive tells where it stands",
                       "choose a base below it");
    T = T * joint.T_parent_joint;
    if (joint.kind == UrdfJoint::Kind::fixed) continue;
    const Eigen::Vector3d axis = (T.linear() * joint.axis).normalized(), point = T.translation();
    if (!joint.mimic) {
      joints[carried].axis = axis;
      joints[carried++].point = point;
      continue;
    }
    const JointSource source = source_of(robot, j);
    const auto leader = std::ranges::find(drives, static_cast<std::size_t>(source.joint));
    if (leader != drives.end())  // else it stays at its offset
      followers.push_back({static_cast<std::size_t>(leader - drives.begin()), carried, source.factor,
                           joint.kind == UrdfJoint::Kind::sliding, axis, point});
    T = T * joint_transform(joint, source.offset);
  }
  return ArmChain(std::move(joints), T, where, std::move(followers));
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
