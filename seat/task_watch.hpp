// A task that a program does at a seat, looked on from outside: when it began, when it ended, and how.
//
//   waits --driving--> under way --done, or too long--> ended
//     '------ failed -----'------------------------------> failed
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "seat/scripted_driver.hpp"

namespace foresight {

/// Where the thing of a task lies once the task is over, as far as who is asked can know.
enum class ThingLies : std::uint8_t {
  in_place,  ///< where it was to be brought; seen there, or nothing was to be brought anywhere
  unseen,    ///< the model has it there, and no image has shown it there
  elsewhere,
};

struct TaskOutcome {
  bool succeeded = false;
  std::string failure;       ///< why not; "" where it did
  double seconds = 0;        ///< from the first press of the switch to the end; 0 where it never was pressed
  double held_share = 0;     ///< of these seconds, those in which the safety gate held the robot back
  std::string held_by = {};  ///< what held it last; "" where nothing did
};

/// Pure logic; one thread.
class TaskWatch {
 public:
  /// What it means that the script still wants something after all its time.
  enum class OverTime : std::uint8_t {
    ends,   ///< nothing, as of a tour that goes on for ever
    fails,  ///< the task was not done
  };
  /// `most_s`: of motion, after which the task ends, whatever the script still wants.
  TaskWatch(double most_s, OverTime over_time) : most_s_(most_s), over_time_(over_time) {}

  /// How the script is at `now`, which never goes back. `hold`: what keeps the robot from where it is asked to be, as
  /// it says (link::RobotState::hold); "" where nothing does.
  void see(RobotTime now, const ScriptState& script, const std::string& hold = {});

  bool began() const { return pressed_.has_value(); }
  /// Driven, and neither ended nor failed: what is shown now counts.
  bool under_way() const { return pressed_ && !ended_ && failure_.empty(); }
  bool failed() const { return !failure_.empty(); }
  /// When it ended; nothing before.
  const std::optional<RobotTime>& ended() const { return ended_; }
  /// Since the first press; 0 before.
  double seconds(RobotTime now) const;

  /// To be asked once all is over. `words`: what the seat says, for a robot that never followed; `where`: is asked
  /// only where it ended. What no image has shown did not succeed: the model takes things along on its own.
  TaskOutcome outcome(RobotTime now, const std::string& words, const std::function<ThingLies()>& where) const;

 private:
  double most_s_;
  OverTime over_time_;
  bool done_ = false;
  std::optional<RobotTime> pressed_, ended_, seen_;
  double held_s_ = 0;
  std::string failure_, held_by_;
};

}  // namespace foresight
