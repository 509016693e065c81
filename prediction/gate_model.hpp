// What a robot's safety gate will do with set-points, by its own steps (motion/guarded_motion) and rules.
//
//   idle --pressed, after it was seen open--> following --opened, expired--> stopping --at rest--> idle
//
// Set-points that expired on their way are not taken, and none is followed that a joint cannot reach. Where the robot's
// end of a line asks for consent (LinePermit), presses have to name the present one, which changes with each loss, and
// one that may not move the robot now does not later either: the switch has to be opened first. Whatever else may keep
// the real gate from following (drives, other operators) it does not know: the next report tells.
#pragma once

#include "motion/guarded_motion.hpp"
#include "prediction/robot_report.hpp"

namespace foresight {

/// What the gate makes of a set-point, which it gets again and again until it expires.
enum class SetPointKind : std::uint8_t { none, open, pressed, refused };

/// One thread. No method but the constructor allocates or throws.
class GateModel {
 public:
  struct State {
    RobotTime time;  ///< of the last cycle
    GateDoing doing = GateDoing::away;
    GuardedMotion::Motions motion{};
    SetPointKind newest = SetPointKind::none;  ///< of the newest set-point; what came with it:
    JointValues target{};
    RobotTime expires;
    RobotTime engaged;
    bool released = false;                      ///< the open switch was seen since the last loss
    std::optional<std::uint64_t> consent = {};  ///< that presses have to name; 0: not known; nothing: none is asked for
    std::uint64_t agreed = 0;                   ///< the one that the newest set-point names
    RobotTime released_at, consent_at;          ///< since when these are so, at least
    std::uint64_t taken = 0;                    ///< number of the newest set-point
    bool blocked = false;                       ///< parts that would come too close keep it from its target
  };

  /// Throws InputError where `options` contradict themselves. `shape` may be null, is told the surroundings, is nobody
  /// else's, and outlives this.
  GateModel(GateOptions options, RobotShape* shape);

  void set(const State& state) noexcept;
  const State& state() const noexcept { return state_; }
  /// Came by `now`, before the cycle at `now`.
  void take(const SentSetPoint& set_point, RobotTime now) noexcept;
  void cycle(RobotTime now) noexcept;
  const GateOptions& options() const noexcept { return options_; }

 private:
  void stop(bool released) noexcept;
  void lose() noexcept;
  void set_released(bool released) noexcept;
  void press(RobotTime now) noexcept;
  void heed_newest(RobotTime now) noexcept;

  GateOptions options_;
  GuardedMotion motion_;
  State state_;
};

}  // namespace foresight
