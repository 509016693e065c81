// A task that a program does at a seat, looked on from outside: when it began, when it ended, and how.
//
//   waits --driving--> under way --done, or too long--> ended
//     '------ failed -----'------------------------------> failed
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "seat/scripted_driver.hpp"

namespace foresight {

struct TaskOutcome {
  bool succeeded = false;
  std::string failure;  ///< why not; "" where it did
  double seconds = 0;   ///< from the first press of the switch to the end; 0 where it never was pressed
};

/// Pure logic; one thread.
class TaskWatch {
 public:
  /// `most_s`: of motion, after which the task ends, whatever the script still wants.
  explicit TaskWatch(double most_s) : most_s_(most_s) {}

  /// How the script is at `now`, which never goes back.
  void see(RobotTime now, const ScriptState& script);

  bool began() const { return pressed_.has_value(); }
  /// Driven, and neither ended nor failed: what is shown now counts.
  bool under_way() const { return pressed_ && !ended_ && failure_.empty(); }
  bool failed() const { return !failure_.empty(); }
  /// When it ended; nothing before.
  const std::optional<RobotTime>& ended() const { return ended_; }
  /// Since the first press; 0 before.
  double seconds(RobotTime now) const;

  /// To be asked once all is over. `words`: what the seat says, for a robot that never followed; `in_place`: whether
  /// things are where the task was to bring them, asked only where it ended.
  TaskOutcome outcome(RobotTime now, const std::string& words, const std::function<bool()>& in_place) const;

 private:
  double most_s_;
  std::optional<RobotTime> pressed_, ended_;
  std::string failure_;
};

}  // namespace foresight
