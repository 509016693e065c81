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

namespace {

const char* what_is_wrong(ThingLies lies) noexcept {
  switch (lies) {
    case ThingLies::in_place: return "";
    case ThingLies::unseen: return "the model says it lies in the tray, but no image has confirmed it";
    case ThingLies::elsewhere: break;
  }
  return "the thing is not in the tray";
}

}  // namespace

TaskOutcome TaskWatch::outcome(RobotTime now, const std::string& words, const std::function<ThingLies()>& where) const {
  TaskOutcome out{false, failure_, seconds(now)};
  if (failed()) return out;
  if (!pressed_)
    out.failure = "it never drove: " + words;
  else if (!ended_)
    out.failure = "stopped before its end";
  else
    out.failure = what_is_wrong(where());
  out.succeeded = out.failure.empty();
  return out;
}

}  // namespace foresight
