#include "seat/task_watch.hpp"

#include <fmt/core.h>

#include <utility>

namespace foresight {

void TaskWatch::see(RobotTime now, const ScriptState& script, const std::string& hold) {
  if (ended_ || failed()) return;
  const RobotTime before = std::exchange(seen_, now).value_or(now);
  if (under_way() && !hold.empty()) {
    held_s_ += to_seconds(now - before);
    held_by_ = hold;
  }
  if (!pressed_ && script.driving) pressed_ = now;
  failure_ = script.failure;
  if (!under_way() || (!script.done && seconds(now) <= most_s_)) return;
  ended_ = now;
  done_ = script.done;
}

double TaskWatch::seconds(RobotTime now) const {
  return pressed_ ? to_seconds(ended_.value_or(now) - *pressed_) : 0;
}

namespace {

constexpr double kMostly = 0.5;  // of the time: what stands so long is no task done

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
  out.held_share = out.seconds > 0 ? held_s_ / out.seconds : 0;
  out.held_by = held_by_;
  if (failed()) return out;
  if (!pressed_)
    out.failure = "it never drove: " + words;
  else if (!ended_)
    out.failure = "stopped before its end";
  else if (out.held_share > kMostly)
    out.failure = "the safety gate held the robot back most of the time: " + held_by_;
  else if (!done_ && over_time_ == OverTime::fails)
    out.failure = fmt::format("not done after {:.0f} s; give it more by --seconds", most_s_);
  else
    out.failure = what_is_wrong(where());
  out.succeeded = out.failure.empty();
  return out;
}

}  // namespace foresight
