#include "drivers/robot/robot_words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "common/text.hpp"

namespace foresight {
namespace {

constexpr const char* kReset = "remove its cause, then reset (r)";
constexpr const char* kConfigure = "configure drives anew (c), then enable them (e)";
constexpr const char* kProgram = "correct the program that commands";
constexpr const char* kStoodStill =
    "look for what held it up, such as a suspended or an overloaded host; then reset (r)";

}  // namespace

StateWords words_for(RobotPhase phase) {
  switch (phase) {
    case RobotPhase::disabled: return {"disabled", "disabled: no torque, brakes closed", "enable the drives (e)"};
    case RobotPhase::enabling:
      return {"enabling", "drives are being enabled", "wait; one that does not get there in 5 s is named"};
    case RobotPhase::ready: return {"ready", "ready; drives hold", "command it"};
    case RobotPhase::homing:
      return {"homing", "joints look for home, one after the other, slowly", "wait; space stops them"};
    case RobotPhase::stopped: return {"stopped", "stopped; drives hold", kReset};
    case RobotPhase::setting_up: return {"setting up", "drives are being configured anew", "wait, a minute at most"};
  }
  return {"?", "?", "?"};
}

StateWords words_for(GateState state) {
  switch (state) {
    case GateState::idle: return {"idle", "nobody commands; set-points stay", "hold the switch and command"};
    case GateState::following: return {"following", "follows the operator", "let go of the switch to stop"};
    case GateState::homing: return {"homing", "a joint looks for home, all others hold", "wait; space stops it"};
    case GateState::stopping: return {"stopping", "slows down to rest", "wait; then command anew"};
    case GateState::stopped: return {"stopped", "stopped; drives hold", kReset};
  }
  return {"?", "?", "?"};
}

StateWords words_for(GateReason reason) {
  switch (reason) {
    case GateReason::none: return {"", "", ""};
    case GateReason::not_finite: return {"not a number", "a commanded position is not a number", kProgram};
    case GateReason::wrong_joint_count:
      return {"joint count", "a command for another number of joints",
              "give both sides the same rig: a command has all of its joints"};
    case GateReason::out_of_range:
      return {"out of range", "a commanded position is beyond the joint's limits",
              "command within min and max of the rig"};
    case GateReason::expired:
      return {"too late", "a command came too late",
              "look for what delays it, or allow more with control.command_age_s"};
    case GateReason::from_the_future:
      return {"future", "a command is stamped in the future", "set the clocks of both machines alike"};
    case GateReason::out_of_order:
      return {"out of order", "a command is older than one before it", "let one program command, over one line"};
    case GateReason::second_operator:
      return {"second operator", "another operator is in charge", "wait until that one lets go"};
    case GateReason::obstructed:
      return {"obstructed", "the way is obstructed", "command it another way, or away from what is named"};
    case GateReason::operator_lost:
      return {"operator lost", "no command in time: the operator is lost",
              "look for what held the commands up; let go of the switch, and engage anew"};
    case GateReason::handed_over:
      return {"handed over", "control changed hands, which stops it",
              "whoever has it now: let go of the switch, and hold it anew"};
    case GateReason::deadman_released: return {"let go", "the switch was released", "hold it again to go on"};
    case GateReason::not_started: return {"not started", "not started yet", "enable the drives (e)"};
    case GateReason::emergency_stop:
      return {"operator's stop", "stopped by the operator; drives hold", "reset (r) once the way is clear"};
    case GateReason::program_ends: return {"program ends", "the program ends", "start it again"};
    case GateReason::homing_too_long:
      return {"homing too long", "homing takes longer than all its ways at homing_velocity",
              "check the home switch and homing_velocity, then reset (r)"};
    case GateReason::homed_out_of_range:
      return {"homed out of range", "after homing, a joint stands beyond its limits",
              "correct offset, direction or the limits in the rig"};
    case GateReason::not_enabled_in_time:
      return {"not enabled", "a drive did not get enabled within 5 s",
              "look at what the drive says of itself: power, safe torque off, brake; then reset (r)"};
    case GateReason::following_error:
      return {"following error", "the joint does not follow its set-points",
              "look for what blocks it, its brake, too much load or acceleration; then reset (r)"};
    case GateReason::feedback_lost:
      return {"feedback lost", "no position from the drive in time",
              "check its cable and the bus load, then reset (r)"};
    case GateReason::feedback_not_finite:
      return {"feedback not a number", "the drive's position is not a number",
              "check counts_per_unit and offset in the rig"};
    case GateReason::feedback_frozen:
      return {"feedback frozen", "the drive's position does not change while it should",
              "check encoder, brake and coupling, then reset (r)"};
    case GateReason::feedback_jumps:
      return {"feedback jumps", "the drive's position jumps", "check the encoder and its cable, then reset (r)"};
    case GateReason::drive_fault:
      return {"drive fault", "the drive reports a fault", "remove the cause that it names, then reset (r)"};
    case GateReason::drive_offline:
      return {"drive offline", "the drive does not answer",
              "check its power and cable; then configure anew (c), and enable (e)"};
    case GateReason::drive_not_enabled:
      return {"drive not enabled", "the drive is no longer enabled",
              "look for who disabled it, such as a safety input; then reset (r)"};
    case GateReason::bus_fault:
      return {"bus fault", "the bus is not usable", "check wiring and termination; `foresight can scan` says more"};
    case GateReason::stands_out_of_range:
      return {"out of limits", "the joint stands beyond its limits",
              "move it back by hand, or correct min and max, then reset (r)"};
  }
  return {"?", "?", "?"};
}

StateWords words_for(DriveState state) {
  switch (state) {
    case DriveState::offline:
      return {"offline", "nothing was heard of it in time", "check its power and cable; then configure anew (c)"};
    case DriveState::disabled: return {"disabled", "no torque, brake closed", "enable the drives (e)"};
    case DriveState::enabling: return {"enabling", "is being enabled", "wait"};
    case DriveState::enabled: return {"enabled", "follows set-points", "command it"};
    case DriveState::homing: return {"homing", "looks for home", "wait; space stops it"};
    case DriveState::stopping: return {"stopping", "slows down after a stop", "wait, then reset (r)"};
    case DriveState::fault: return {"fault", "reports a fault", "remove the cause that it names, then reset (r)"};
  }
  return {"?", "?", "?"};
}

const char* to_string(RobotPhase phase) {
  return words_for(phase).label;
}
const char* to_string(GateState state) {
  return words_for(state).label;
}
const char* to_string(GateReason reason) {
  return words_for(reason).name;
}

namespace {

std::string name_of(int joint, std::span<const JointWords> joints) {
  const auto index = static_cast<std::size_t>(joint);
  return joint < 0 || index >= joints.size() ? "" : joints[index].name;
}

/// "the drive reports a fault (elbow): overcurrent"
std::string reason_text(const GateStatus& gate, std::span<const JointWords> joints) {
  std::string out = words_for(gate.reason).name;
  if (const std::string joint = name_of(gate.joint, joints); !joint.empty()) out += " (" + joint + ")";
  if (*gate.detail != '\0') out += std::string(": ") + gate.detail;
  return out;
}

/// ", but for finger, which keeps its grip": those whose drives hold while all others are disabled; "" where none does.
std::string grips_text(const RobotStatus& status, std::span<const JointWords> joints) {
  std::vector<std::string> grip;
  for (std::size_t i = 0; i < std::min(joints.size(), status.feedback.size()); ++i)
    if (status.feedback[i].state == DriveState::enabled) grip.push_back(joints[i].name);
  if (grip.empty()) return "";
  return ", but for " + joined(grip) + ", which " + (grip.size() == 1 ? "keeps its" : "keep their") + " grip";
}

/// Some drive cannot be enabled before it was configured anew.
bool any_offline(const RobotStatus& status, std::size_t joints) {
  const auto feedback = std::span(status.feedback).first(std::min(joints, status.feedback.size()));
  return std::ranges::find(feedback, DriveState::offline, &DriveFeedback::state) != feedback.end();
}

/// Whether drives stop the robot so when they hear nothing.
bool comes_of_silence(GateReason reason) {
  switch (reason) {
    case GateReason::following_error:
    case GateReason::feedback_lost:
    case GateReason::feedback_frozen:
    case GateReason::feedback_jumps:
    case GateReason::drive_fault:
    case GateReason::drive_offline:
    case GateReason::drive_not_enabled:
    case GateReason::bus_fault: return true;
    default: return false;
  }
}

RobotWords describe_stop(const RobotStatus& status, std::span<const JointWords> joints) {
  const GateReason reason = status.gate.reason;
  const std::string text = reason_text(status.gate, joints);
  if (reason == GateReason::emergency_stop) return {text, words_for(reason).cure};
  if (status.stood_still > Duration{} && comes_of_silence(reason))
    return {fmt::format("stopped: the program stood still for {:.1f} s, then {}; drives hold",
                        to_seconds(status.stood_still), text),
            kStoodStill};
  if (reason == GateReason::not_enabled_in_time && any_offline(status, joints.size()))
    return {"stopped: " + text + "; drives hold", kConfigure};
  return {"stopped: " + text + "; drives hold", words_for(reason).cure};
}

}  // namespace

RobotWords describe(const RobotStatus& status, std::span<const JointWords> joints) {
  const GateReason reason = status.gate.reason;
  RobotWords out{words_for(status.phase).name, words_for(status.phase).cure};
  const bool by_hand = reason == GateReason::emergency_stop;
  if (status.phase == RobotPhase::disabled) out.name += grips_text(status, joints);
  if (status.phase == RobotPhase::disabled && any_offline(status, joints.size())) out.cure = kConfigure;
  if (status.phase == RobotPhase::stopped && reason != GateReason::none) {
    out = describe_stop(status, joints);
  } else if (status.phase == RobotPhase::ready && status.gate.state != GateState::idle) {
    out = {std::string("ready, ") + words_for(status.gate.state).name, words_for(status.gate.state).cure};
    if (reason != GateReason::none) {
      out.name += ": " + reason_text(status.gate, joints);
      out.cure = words_for(reason).cure;
    }
  } else if (status.phase == RobotPhase::ready && reason != GateReason::none) {
    out = {"ready; last, " + reason_text(status.gate, joints), words_for(reason).cure};
  }
  if (status.phase == RobotPhase::ready && !status.all_homed && reason == GateReason::none)
    out = {"drives hold; not all joints know where they are", "home them (h)"};
  if (const std::string joint = name_of(status.waiting_for, joints);
      !joint.empty() && status.gate.joint < 0 && !by_hand)
    out.name += ", waiting for " + joint;
  return out;
}

std::string position_text(double position, const std::string& unit) {
  return fmt::format("{:.4f} {}", position, unit);
}

std::string place_text(const JointWords& joint, double stands, double should) {
  return "joint " + joint.name + " stands at " + position_text(stands, joint.unit) + " and should be at " +
         position_text(should, joint.unit);
}

std::string parts_text(const GateHold& hold) {
  if (hold.kept_apart <= 0) return fmt::format("{} ({:.1f} mm before its end)", hold.parts, 1e3 * hold.apart);
  return fmt::format("{} ({:.1f} mm apart, {:.1f} mm are kept)", hold.parts, 1e3 * hold.apart, 1e3 * hold.kept_apart);
}

std::string held_text(const GateHold& hold, const JointWords& joint) {
  if (position_text(hold.stands, joint.unit) == position_text(hold.asked, joint.unit)) return parts_text(hold);
  return place_text(joint, hold.stands, hold.asked) + ": " + parts_text(hold);
}

std::string hold_text(const GateHold& hold, std::span<const JointWords> joints, RobotTime now) {
  const auto joint = static_cast<std::size_t>(hold.joint);
  if (hold.joint < 0 || joint >= joints.size()) return "";
  return fmt::format("held for {:.1f} s: ", to_seconds(now - hold.since)) + held_text(hold, joints[joint]);
}

}  // namespace foresight
