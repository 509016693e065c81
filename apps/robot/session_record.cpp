#include "apps/robot/session_record.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

using Doing = SessionRecord::Doing;

/// The one that is farther from 0; not a number is nearest.
double larger(double a, double b) {
  return std::isnan(a) || std::abs(b) > std::abs(a) ? b : a;
}

Doing doing_of(const RobotCycle& cycle) {
  switch (cycle.phase) {
    case RobotPhase::disabled:
    case RobotPhase::enabling:
    case RobotPhase::setting_up: return Doing::nothing;
    case RobotPhase::homing: return Doing::homing;
    case RobotPhase::stopped: return Doing::stopped;
    case RobotPhase::ready: break;
  }
  if (cycle.gate == GateState::following) return cycle.hold.joint >= 0 ? Doing::held : Doing::following;
  return cycle.gate == GateState::stopping ? Doing::stopping : Doing::ready;
}

/// The same words as in the terminal.
RobotWords words_of(const RobotCycle& cycle, Doing doing, const std::vector<JointWords>& joints) {
  if (doing == Doing::held)
    return {"held back: " + held_text(cycle.hold, joints[static_cast<std::size_t>(cycle.hold.joint)]),
            words_for(GateReason::obstructed).cure};
  RobotStatus status;
  status.phase = cycle.phase;
  status.gate.state = cycle.gate;
  status.gate.reason = cycle.reason;
  status.gate.joint = cycle.reason_joint;
  status.gate.detail = cycle.detail;
  return describe(status, joints);
}

}  // namespace

SessionRecord::SessionRecord(const Rig& rig, BroadcastRing<RobotCycle>::Reader cycles)
    : rig_(rig), joints_(rig.joint_words()), cycles_(cycles), last_set_point_(rig.joints.size(), NAN) {}

void SessionRecord::write(const std::vector<BusLine>& buses) {
  while (const auto cycle = cycles_.take()) add(*cycle);
  if (columns_.empty()) return;
  Column& column = columns_.back();
  column.load.resize(buses.size(), 0);
  for (std::size_t i = 0; i < buses.size(); ++i) column.load[i] = std::max(column.load[i], buses[i].load);
}

void SessionRecord::add(const RobotCycle& cycle) {
  if (begin_.ns == 0) begin_ = cycle.time;
  const double time = to_seconds(cycle.time - begin_);
  add_stretch(cycle, time);
  Column& column = column_at(time);
  for (std::size_t i = 0; i < std::min(joints_.size(), cycle.joints); ++i) {
    const JointCycle& now = cycle.joint[i];
    JointColumn& joint = column.joints[i];
    const double position = now.homed && now.time.ns != 0 ? now.position : NAN;
    const bool follows = now.drive == DriveState::enabled && cycle.phase != RobotPhase::enabling;
    joint.position = position;
    joint.asked = now.asked;
    joint.set_point = follows ? now.set_point.position : NAN;
    joint.error = larger(joint.error, position - last_set_point_[i]);
    joint.velocity = larger(joint.velocity, now.velocity);
    if (std::isfinite(now.velocity))
      column.speed = std::max(column.speed, std::abs(now.velocity) / rig_.joints[i].drive.max_velocity);
    last_set_point_[i] = joint.set_point;
  }
}

SessionRecord::Column& SessionRecord::column_at(double time) {
  if (columns_.empty() || time >= columns_.back().time_s + width_s_) {
    if (columns_.size() >= kMostColumns) halve();
    columns_.push_back(
        {std::floor(time / width_s_ + 1e-9) * width_s_, 0, std::vector<JointColumn>(joints_.size()), {}});
  }
  return columns_.back();
}

/// Two columns become one.
void SessionRecord::halve() {
  width_s_ *= 2;
  std::vector<Column> out;
  for (Column& column : columns_) {
    const double begin = std::floor(column.time_s / width_s_ + 1e-9) * width_s_;
    if (out.empty() || begin > out.back().time_s + 0.5 * width_s_) {
      column.time_s = begin;
      out.push_back(std::move(column));
      continue;
    }
    Column& into = out.back();
    into.speed = std::max(into.speed, column.speed);
    into.load.resize(std::max(into.load.size(), column.load.size()), 0);
    for (std::size_t i = 0; i < column.load.size(); ++i) into.load[i] = std::max(into.load[i], column.load[i]);
    for (std::size_t i = 0; i < into.joints.size(); ++i) {
      const JointColumn &first = into.joints[i], &second = column.joints[i];
      into.joints[i] = {second.position, second.asked, second.set_point, larger(first.error, second.error),
                        larger(first.velocity, second.velocity)};
    }
  }
  columns_ = std::move(out);
}

void SessionRecord::add_stretch(const RobotCycle& cycle, double time) {
  const Doing doing = doing_of(cycle);
  // What holds the robot is said in `held`; the reason beside it comes and goes from cycle to cycle.
  const GateReason reason = doing == Doing::held                                   ? GateReason::obstructed
                            : doing == Doing::following || doing == Doing::nothing ? GateReason::none
                                                                                   : cycle.reason;
  if (!stretches_.empty()) {
    Stretch& last = stretches_.back();
    last.to_s = time;
    if ((last.doing == doing && last.phase == cycle.phase && last.reason == reason) ||
        stretches_.size() >= kMostStretches) {
      if (doing == Doing::held) last.name = words_of(cycle, doing, joints_).name;  // at its end
      return;
    }
  }
  const RobotWords words = words_of(cycle, doing, joints_);
  stretches_.push_back({time, time, doing, cycle.phase, reason, words.name, words.cure});
}

}  // namespace foresight
