// What to tell a CiA 402 drive next, given what it says and what is asked of it. Pure.
#pragma once

#include <cstdint>

#include "drivers/canopen/cia402.hpp"
#include "drivers/drive/drive.hpp"

namespace foresight::canopen {

/// One step a cycle. It enables only upon a request, and lets go of it at every fault, reset or loss; so no
/// drive comes back by itself. Neither throws nor allocates. One thread.
///
///   off --enable--> enable --home--> home --done--> enable       any --quick_stop--> quick_stop
///   any --fault--> off --reset_fault--> reset --> off            enable --lost by the drive--> off or quick_stop
class Cia402Machine {
 public:
  /// `mode`: that of normal operation. `can_home`: whether a homing method is set.
  Cia402Machine(OperationMode mode, bool can_home) : mode_(mode), wanted_mode_(mode), can_home_(can_home) {}

  struct Input {
    std::uint16_t status = 0;  ///< newest status word
    int mode_shown = 0;        ///< newest 6061h
    bool may_enable = false;   ///< set-up proven, process data fresh; false also ends an enabled state
    bool error_told = false;   ///< an emergency message that is not withdrawn
  };

  /// Kept for the next step; of several, the last one counts, but quick_stop stays.
  void request(DriveRequest what) noexcept;
  /// The control word to send now.
  std::uint16_t step(const Input& in, RobotTime now) noexcept;
  /// Forgets all requests: after set-up, after a loss.
  void restart() noexcept;

  DriveState state() const noexcept;
  bool idle() const noexcept { return goal_ == Goal::off; }  ///< nothing is asked for but what is pending
  /// The drive takes set-points now; otherwise it gets its own actual position.
  bool follows() const noexcept { return follows_; }
  OperationMode wanted_mode() const noexcept { return wanted_mode_; }  ///< to be written to 6060h
  int last_transition() const noexcept { return transition_; }         ///< 0 .. 16; -1: not one of the standard
  bool homed() const noexcept { return homed_; }
  void set_homed(bool homed) noexcept { homed_ = homed; }
  /// A reset was taken up: what was told before counts no more.
  bool resetting() const noexcept { return goal_ == Goal::reset; }
  /// Why the last request ended otherwise than asked; static text, "" where it did not.
  const char* trouble() const noexcept { return trouble_; }

 private:
  enum class Goal : std::uint8_t { off, enable, home, quick_stop, reset };
  void observe(const Input& in) noexcept;
  void take_request(const Input& in) noexcept;
  void check_lost(const Input& in) noexcept;
  std::uint16_t control(const Input& in) noexcept;
  std::uint16_t home(const Input& in) noexcept;
  std::uint16_t reset_edge() noexcept;
  void set_goal(Goal goal) noexcept;

  OperationMode mode_, wanted_mode_;
  bool can_home_, homed_ = false, follows_ = false;
  Goal goal_ = Goal::off;
  DriveRequest pending_ = DriveRequest::none;
  Cia402State state_ = Cia402State::not_ready;
  bool known_ = false;  // the newest status word names a state
  int transition_ = 0;
  bool was_operational_ = false;  // since the goal was set
  int cycles_ = 0;                // of the current phase of homing or reset
  RobotTime now_, since_;         // of the newest step, and when the goal was set
  const char* trouble_ = "";
};

}  // namespace foresight::canopen
