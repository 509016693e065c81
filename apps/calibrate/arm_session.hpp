// A hand-eye as one session on the robot: go through the safety gate from station to station, hold still, look, solve.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line/command_line.hpp"

namespace foresight {

struct ArmSessionOptions {
  bool guided = false;
  std::filesystem::path rig;
  std::string board, side = "left", base, flange;  ///< links; "": as read_joint_chain() chooses
  std::filesystem::path views;                     ///< folder for pictures and joints; must not exist, or be empty
  std::vector<double> start;                       ///< of the chain's joints: where the board is in view; empty: here
  bool mock = false, stepped = false, may_home = false;
  int most_views = 20;
  unsigned seed = 1;
};

void add_arm_session(Command& command, ArmSessionOptions& options);

/// Moves the robot and fills the folder: pictures in which the board was seen while all joints stood still, and
/// joints.csv with their positions, as read_arm_views() takes them. Says on stderr what it does. Blocks. False: SIGINT
/// or SIGTERM ended it. Then, and where it throws, nothing of the folder stays; where the board was not seen, the last
/// picture without it is FOLDER-unseen.png. Throws InputError (a rig without robot or cameras, a start beyond a joint's
/// limits, a board that is not in view at the start) and RuntimeFailure (the robot stopped, cameras are silent, fewer
/// than 8 views).
bool run_arm_session(const ArmSessionOptions& options);

}  // namespace foresight
