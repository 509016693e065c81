// What an operator is to see and read of his hand: where it is, what is in its way, what the arm has left.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "input/hand_control.hpp"
#include "seat/contact_guard.hpp"
#include "seat/seat_words.hpp"

namespace foresight {

/// A joint near an end of its range.
struct NearLimit {
  std::size_t joint = 0;                      ///< of the robot
  double share = 0;                           ///< of the way from the middle of its range to that end; 1: there
  double position = 0, lower = 0, upper = 0;  ///< rad or m
};

/// A copy: any thread.
struct HandSight {
  HandPhase phase = HandPhase::released;
  bool has_tool = false;  ///< the robot has an arm whose tool can be moved
  HandMode mode = HandMode::tool;
  std::size_t joint = 0;                 ///< that is moved alone, where `mode` says so
  std::optional<Pose> T_world_hand;      ///< where the hand asks the tool to be; while driving the tool
  Pose T_world_tool = Pose::Identity();  ///< where what is sent puts the tool
  std::size_t joints = 0;                ///< 0: nothing is known of them
  JointValues positions{};               ///< as sent
  FollowReason follow = FollowReason::none;
  int follow_joint = -1;
  TouchSight touch;               ///< as of the last step of the arm
  std::vector<NearLimit> limits;  ///< the nearest first
};

inline constexpr double kNearLimit = 0.9;  ///< share from which on an end of a joint's range is near

/// Joints of the arm that are near an end of their range.
std::vector<NearLimit> near_limits(const HandOptions& hand, const JointValues& positions);

/// For the head-up display: what touches, how near things are, joints near their limits, what the
/// hand moves. `names`:
/// of the joints.
std::vector<SeatLine> hand_lines(const HandSight& sight, std::span<const std::string> names);
/// "joint 4 (elbow) at 96 % of its range"
std::string words_of(const NearLimit& limit, std::span<const std::string> names);

}  // namespace foresight
