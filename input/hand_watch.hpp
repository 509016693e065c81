// Judges what a device says before anything follows it: is it there, is its time ours, is it still talking, can a hand
// have moved like that?
#pragma once

#include <optional>

#include "input/tracker.hpp"

namespace foresight {

/// What keeps a hand from counting.
enum class HandFault : std::uint8_t {
  none,
  device_gone,    ///< not connected
  wrong_clock,    ///< its instants are not of this host's clock
  frozen,         ///< it says nothing new
  tracking_lost,  ///< connected, but its pose does not count
  bad_pose,       ///< not finite, or not a rigid pose
  jumped,         ///< farther than a hand can go
};

struct HandWatchOptions {
  /// A device that says nothing new for longer is frozen.
  Duration frozen_after = std::chrono::milliseconds(200);
  /// Instants that are further ahead of ours, or as far behind as `other_clock`, are another clock's.
  Duration ahead = std::chrono::milliseconds(50);
  Duration other_clock = std::chrono::minutes(10);
  double fastest = 4;        ///< m/s: a step faster than this and longer than `least_jump` is a jump
  double fastest_turn = 40;  ///< rad/s, likewise (a hand's tremor at the limit of what is recorded: 436 deg/s usual)
  double least_jump = 0.05;  ///< m; and rad times 4
};

/// One thread. Nothing throws or allocates.
class HandWatch {
 public:
  struct Verdict {
    HandFault buttons = HandFault::none;  ///< what keeps buttons and axes from counting
    HandFault pose = HandFault::none;     ///< what keeps the pose from counting
    bool news = false;                    ///< a pose that counts, and that was captured after the one before
  };

  explicit HandWatch(const HandWatchOptions& options = {}) noexcept : options_(options) {}
  Verdict judge(OperatorTime now, const TrackerState& state) noexcept;

 private:
  HandFault of_time(OperatorTime now, const TrackerState& state) noexcept;
  bool jumps(OperatorTime time, const Pose& pose) const noexcept;

  HandWatchOptions options_;
  std::optional<OperatorTime> newest_;  // of any state
  struct Seen {
    OperatorTime time;
    Pose pose = Pose::Identity();
  };
  std::optional<Seen> seen_;  // the last pose that counted
};

}  // namespace foresight
