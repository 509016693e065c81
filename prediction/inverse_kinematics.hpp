// From a pose of the tool to positions of the joints.
//
// Arms with spherical shoulder and wrist are solved in closed form (prediction/spherical_arm.hpp); all others step by
// step, from the middle of their limits and then from a fixed series of places (prediction/descent.hpp). Either way the
// same question gets the same answer, bit for bit.
#pragma once

#include <memory>
#include <optional>

#include "prediction/arm_chain.hpp"
#include "prediction/descent.hpp"
#include "prediction/spherical_arm.hpp"

namespace foresight {

enum class IkStatus {
  solved,      ///< the pose is the target, to kIkExact; of position_first() arms its position
  nearest,     ///< out of reach within the limits: the nearest pose that was found
  bad_target,  ///< not a finite rigid pose: the joints are those that were given, or the middle ones
};

inline constexpr double kIkExact = 1e-9;  ///< m and rad

struct IkAnswer {
  IkStatus status = IkStatus::bad_target;
  JointVector q;                       ///< within the limits
  Pose T_base_tip = Pose::Identity();  ///< where the tip is with these joints
  double position_error = 0;           ///< m from the target
  double rotation_error = 0;           ///< rad from the target; where the position comes first, whatever is left
  double largest_change = 0;           ///< rad or m of one joint, from those that were given; 0 where none were
};

/// Immutable; any thread. No method but the constructor and description() allocates or throws.
class InverseKinematics {
 public:
  explicit InverseKinematics(ArmChain chain);

  const ArmChain& chain() const noexcept { return chain_; }
  bool closed_form() const noexcept { return spherical_.has_value(); }
  /// An arm of fewer than six joints cannot choose its tip's orientation: the position is reached, and the tip turned
  /// to the target as nearly as that allows.
  bool position_first() const noexcept { return chain_.size() < 6; }
  /// "seven joints with spherical shoulder and wrist: closed form", for people.
  std::string description() const;
  /// What counts as much as one rad where a target is out of reach, m: a third of the arm's reach.
  double length() const noexcept { return length_; }

  /// The joints for a target wherever the arm is now. In closed form, those with the largest margin to limits and
  /// singularities; step by step, the first that are found; where the position comes first, those of the first few that
  /// turn the tip nearest to the target.
  IkAnswer solve(const Pose& T_base_tip) const noexcept;

  /// The joints for a target that are near `last` (one per joint). An answer may still be a reach away, where no nearer
  /// one exists: see largest_change, and PathFollower for a way that never jumps. In closed form the elbow moves up to
  /// `swivel` rad to where limits and singularities are farther.
  IkAnswer solve(const Pose& T_base_tip, const JointVector& last, double swivel = 0.02) const noexcept;

 private:
  IkAnswer answer(IkStatus status, const JointVector& q, const Pose& target) const noexcept;
  IkAnswer refined(const JointVector& q, const Pose& target) const noexcept;
  IkAnswer turned_off_limits(const Pose& target) const noexcept;
  IkAnswer search(const Pose& target, const JointVector* last) const noexcept;
  IkAnswer search_position_first(const Pose& target, const JointVector* last) const noexcept;
  IkAnswer nearest_below(const Pose& target, const JointVector& q) const noexcept;
  DescentGoal goal(const Pose& target) const noexcept;

  ArmChain chain_;
  std::optional<SphericalArm> spherical_;
  double length_ = 1;
};

}  // namespace foresight
