// The joints between a robot's base and its tool, in the form that inverse kinematics works on.
//
// The pose of the tip is a product of exponentials (Brockett 1984; Lynch and Park, Modern Robotics, section 4.1):
//
//   T_base_tip(q) = exp(s_1 q_1) ... exp(s_n q_n) T_base_tip(0)
//
// where s_i is the line that joint i turns about (or the direction that it slides in) while all joints stand at 0.
// Which frames a URDF puts between the joints, and which way its axes point, is then of no more importance.
//
// Some of these lines have no drive: their joints follow others, as those do that keep a palletiser's hand level. There
// q_i is a driven joint's, times a factor; a column of the Jacobian is the sum over all lines that its joint moves.
// What such a follower stands at when its leader is at 0 is in the lines' places.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scene/urdf_reader.hpp"

namespace foresight {

inline constexpr std::size_t kMostArmJoints = 12;
inline constexpr std::size_t kMostArmLines = 24;  ///< with those that follow

/// One number per joint, in rad or m. Never allocates.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, static_cast<int>(kMostArmJoints), 1>;
/// Those of all of a robot's positions that `joints` are the indices of, no more than kMostArmJoints.
JointVector joints_of(std::span<const double> positions, std::span<const std::size_t> joints) noexcept;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// A joint with a drive.
struct ArmJoint {
  std::string name;
  bool slides = false;
  Eigen::Vector3d axis{0, 0, 1};   ///< unit vector, in the base frame, with all joints at 0
  Eigen::Vector3d point{0, 0, 0};  ///< on that axis, in the base frame, with all joints at 0
  double lower = 0, upper = 0;     ///< rad or m; infinite for a continuous joint
  double velocity = 0;             ///< largest, rad/s or m/s, > 0
  bool velocity_known = true;      ///< false: the URDF says none, and kAssumedVelocity stands in
  bool carries_tip = true;         ///< false: it moves the tip by what follows it alone, as a lever beside the arm does
};

/// A joint between base and tip that goes where a driven one puts it.
struct ArmFollower {
  std::size_t leader = 0;  ///< of the chain's joints
  std::size_t after = 0;   ///< so many of the joints that carry the tip are nearer to the base
  double factor = 1;       ///< rad or m per rad or m of its leader
  bool slides = false;
  Eigen::Vector3d axis{0, 0, 1};   ///< as of ArmJoint
  Eigen::Vector3d point{0, 0, 0};  ///< as of ArmJoint
};

/// What the tip turns about or slides along: a joint's own line, or that of one which follows it.
struct ArmLine {
  std::size_t joint = 0;
  double factor = 1;
  bool slides = false;
  Eigen::Vector3d axis{0, 0, 1};
  Eigen::Vector3d point{0, 0, 0};
};

inline constexpr double kAssumedVelocity = 1;  ///< rad/s or m/s

/// Change of the tip per change of each joint: of the tip's position (m), then of its rotation vector (rad), both in
/// the base frame.
using TipChange = std::array<Vector6, kMostArmJoints>;
/// The same per rad or m of each line, as if it had a drive of its own.
using LineChange = std::array<Vector6, kMostArmLines>;

/// Immutable; any thread. No method but the constructor allocates or throws.
class ArmChain {
 public:
  /// `joints` and `followers` from the base on; joints that do not carry the tip are the last. Throws InputError at
  /// `where`: no joint or more than kMostArmJoints, more than kMostArmLines lines, numbers that are not finite, lower
  /// >= upper, a velocity <= 0.
  ArmChain(std::vector<ArmJoint> joints, const Pose& T_base_tip_at_zero, const std::string& where,
           std::vector<ArmFollower> followers = {});

  std::size_t size() const noexcept { return joints_.size(); }
  std::span<const ArmJoint> joints() const noexcept { return joints_; }
  const std::vector<ArmFollower>& followers() const noexcept { return followers_; }
  std::span<const ArmLine> lines() const noexcept { return lines_; }  ///< from the base to the tip; at least one
  const JointVector& lower() const noexcept { return lower_; }
  const JointVector& upper() const noexcept { return upper_; }
  const Pose& tip_at_zero() const noexcept { return T_base_tip_at_zero_; }
  /// The middle of each joint's range; 0, or the limit nearest to it, where the range has no end.
  const JointVector& middle() const noexcept { return middle_; }
  /// No point of the tip is farther than this from the first line's point, m (sliding joints: fully out).
  double reach() const noexcept { return reach_; }

  /// T_base_tip at `q`, of size() finite numbers.
  Pose tip_pose(const JointVector& q) const noexcept;
  /// The same, and how it changes with each joint. The first size() entries of `change` are set.
  Pose tip_pose(const JointVector& q, TipChange& change) const noexcept;
  /// The same by lines. The first lines().size() entries of `change` are set.
  Pose tip_pose(const JointVector& q, LineChange& change) const noexcept;
  bool within_limits(const JointVector& q, double tolerance = 0) const noexcept;

 private:
  void require_lines(const std::string& where) const;

  std::vector<ArmJoint> joints_;
  std::vector<ArmFollower> followers_;
  std::vector<ArmLine> lines_;
  Pose T_base_tip_at_zero_;
  JointVector lower_, upper_, middle_;
  double reach_ = 0;
};

/// The joints that move link `tip` against link `base` (empty: the root): those between the two, then those beside the
/// way that something on it follows. Their limits are within those of all that follow them. Visuals are not read: a
/// URDF without its meshes will do. Throws InputError naming file, link or joint: what read_urdf refuses; no such link
/// (with the nearest); a tip that is not below the base, or with no moving joint between the two, or more than ArmChain
/// takes; a joint on the way that is floating or planar; one whose limits, or those of what follows it, leave it no way
/// to move, or whose numbers are not finite.
ArmChain read_arm_chain(const std::filesystem::path& urdf, const std::string& tip, const std::string& base = "");
/// The same of a robot that was read; messages name `where`.
ArmChain arm_chain(const UrdfRobot& robot, const std::string& tip, const std::string& base, const std::string& where);

/// What lies between two poses of the tip, in the base frame: position, then rotation vector. exp(step) * now = then.
Vector6 pose_difference(const Pose& now, const Pose& then) noexcept;

/// The pose a share of the way from one to another: position and rotation each go straight and evenly.
Pose pose_between(const Pose& from, const Pose& to, double share) noexcept;

}  // namespace foresight
