// The set-points of all joints of a robot, cycle by cycle: what its safety gate sends, and what others predict of it by
// the same steps.
//
//   targets --> approach() per joint --> whole arm clear until it stands? --> the next set-points
//                                              |
//                                              no: slowly away from what is too close, where that parts; else brake()
//
// From each of them the robot can stop within all limits, clear of everything.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "motion/gate_options.hpp"

namespace foresight {

/// One thread. Nothing allocates after construction or throws but the constructor.
class GuardedMotion {
 public:
  using Motions = std::array<JointMotion, kMostJoints>;
  /// What keeps the robot from its targets.
  struct Blocked {
    std::size_t couple = 0;  ///< of the shape: parts that would come too close
    double margin = 0;       ///< of them where the robot stands: RobotShape::margins()
  };

  /// Throws InputError where `options` contradict themselves. `shape` (may be null: then nothing is checked against the
  /// surroundings) gets positions in the order of the joints, and is told the surroundings; it outlives this.
  GuardedMotion(const GateOptions& options, RobotShape* shape);

  /// From where the next cycle goes on.
  void set(std::size_t joint, const JointMotion& motion) noexcept { motion_[joint] = motion; }
  const JointMotion& operator[](std::size_t joint) const noexcept { return motion_[joint]; }
  const Motions& all() const noexcept { return motion_; }

  /// A cycle towards `targets`, finite, at `speed` (0 .. 1) of the velocities. What is in the way, if anything is.
  std::optional<Blocked> go_towards(const JointValues& targets, double speed) noexcept;
  /// A cycle of the fastest stop.
  void halt() noexcept;
  bool at_rest() const noexcept;

 private:
  struct Next {
    Motions motion;
    JointValues stop{};  // where the fastest stop from there ends
  };
  Next towards(const JointValues& targets, double speed) const noexcept;
  template <typename Check>
  bool all_to_rest(const Next& next, Check&& check) noexcept;
  std::optional<std::size_t> blocking(const Next& next) noexcept;
  void measure_here() noexcept;
  bool retreats(const Next& next) noexcept;

  std::vector<JointLimits> limits_;
  double dt_;
  RobotShape* shape_;
  Motions motion_{};
  std::vector<double> here_, there_;  // margins of the shape's couples
};

}  // namespace foresight
