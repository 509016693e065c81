// What an operator is told about the hand.
#include "input/hand_control.hpp"

namespace foresight {
namespace {

HandWords words_for(HandReason reason) {
  switch (reason) {
    case HandReason::none:
    case HandReason::device: return {};
    case HandReason::not_let_go: return {"the switch was held from the begin", "let it go, and press it again"};
    case HandReason::robot_unknown:
      return {"nothing is known of the robot's joints", "wait for the robot; let go, and press again"};
    case HandReason::robot_not_ready:
      return {"the robot would not follow", "see what it says; let go, and press again"};
    case HandReason::robot_lost:
      return {"the robot no longer follows", "let go, and press again: it goes on from where it stands"};
    case HandReason::robot_silent:
      return {"the robot did not begin to follow", "see what it says; let go, and press again"};
    case HandReason::paused: return {"this program stood still", "let go, and press again"};
    case HandReason::no_start:
      return {"this robot has no start position", "write one to the rig: `start:` of its joints"};
    case HandReason::no_arm: return {"this robot has no arm whose tool could be moved", "move single joints"};
    case HandReason::bad_number:
      return {"a joint's position is no number", "see what the robot says of its drives; let go, and press again"};
  }
  return {};
}

}  // namespace

const char* to_string(TrackerButton button) noexcept {
  switch (button) {
    case TrackerButton::deadman: return "switch";
    case TrackerButton::clutch: return "clutch";
    case TrackerButton::gripper_open: return "gripper_open";
    case TrackerButton::gripper_close: return "gripper_close";
    case TrackerButton::home_view: return "home_view";
    case TrackerButton::recentre: return "recentre";
    case TrackerButton::joint_mode: return "joint_mode";
    case TrackerButton::next_joint: return "next_joint";
    case TrackerButton::previous_joint: return "previous_joint";
    case TrackerButton::to_start: return "to_start";
  }
  return "?";
}

HandWords words_for(HandFault fault) {
  switch (fault) {
    case HandFault::none: return {};
    case HandFault::device_gone: return {"the device has gone", "connect it; let go, and press again"};
    case HandFault::wrong_clock: return {"the device's instants are of another clock", "start its program anew"};
    case HandFault::frozen: return {"the device says nothing new", "see that it is awake; let go, and press again"};
    case HandFault::tracking_lost:
      return {"the hand is not tracked", "bring it where its tracker sees it; let go, and press again"};
    case HandFault::bad_pose: return {"the device's pose is none", "start its program anew; let go, and press again"};
    case HandFault::jumped: return {"the hand jumped farther than a hand can go", "let go, and press again"};
  }
  return {};
}

HandWords words_for(FollowReason reason, const std::string& joint) {
  const std::string of_joint = joint.empty() ? "a joint" : "joint " + joint;
  switch (reason) {
    case FollowReason::none: return {};
    case FollowReason::joint_speed: return {of_joint + " goes as fast as it may", "move more slowly"};
    case FollowReason::joint_limit: return {of_joint + " stands at its limit", "come another way"};
    case FollowReason::singularity:
      return {"the arm is stretched or folded, and hardly moves that way",
              "move across it slowly, or go to the start position"};
    case FollowReason::out_of_reach: return {"the hand is out of the arm's reach", "come back"};
    case FollowReason::few_joints:
      return {"the arm has too few joints to turn as your hand does", "its place is followed; turn your hand back"};
    case FollowReason::other_branch:
      return {"the arm would have to come round another way", "move single joints, or come another way"};
    case FollowReason::contact: return {"something is in the way", "move away"};
    case FollowReason::unknown: return {"what is around the arm is not known", "wait; let go, and press again"};
    case FollowReason::bad_target: return {"the hand's target is no pose", "let go, and press again"};
  }
  return {};
}

HandWords describe(const HandCycle& cycle, const std::vector<GateJoint>& joints) {
  if (cycle.reason == HandReason::device) {
    HandWords words = words_for(cycle.fault);
    if (*cycle.trouble) words.name = cycle.trouble;
    if (*cycle.cure) words.cure = cycle.cure;
    return words;
  }
  if (cycle.reason != HandReason::none) return words_for(cycle.reason);
  const bool named = cycle.follow_joint >= 0 && static_cast<std::size_t>(cycle.follow_joint) < joints.size();
  return words_for(cycle.follow, named ? joints[static_cast<std::size_t>(cycle.follow_joint)].name : "");
}

}  // namespace foresight
