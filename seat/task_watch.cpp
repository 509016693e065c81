#include "seat/task_watch.hpp"

namespace foresight {

void TaskWatch::see(RobotTime now, const ScriptState& script) {
  if (ended_ || failed()) return;
  if (!pressed_ && script.driving) pressed_ = now;
  failure_ = script.failure;
  if (under_way() && (script.done || seconds(now) > most_s_)) ended_ = now;
}

double TaskWatch::seconds(RobotTime now) const {
  return pressed_ ? to_seconds(ended_.value_or(now) - *pressed_) : 0;
}

TaskOutcome TaskWatch::outcome(RobotTime now, const std::string& words, const std::function<bool()>& in_place) const {
  TaskOutcome out{false, failure_, seconds(now)};
  if (failed()) return out;
  if (!pressed_)
    out.failure = "it never drove: " + words;
  else if (!ended_)
    out.failure = "stopped before its end";
  else if (!in_place())
    out.failure = "the thing is not in the tray";
  out.succeeded = out.failure.empty();
  return out;
}

}  // namespace foresight
