// What `calibrate arm` and `verify` of its result read: views of a board, and where the robot stood in each.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line/command_line.hpp"
#include "calibration/robot/joint_chain.hpp"
#include "calibration/robot/robot_results.hpp"

namespace foresight {

struct ArmInput {
  std::optional<std::filesystem::path> images, corners;           ///< one of them, or
  std::optional<std::filesystem::path> run;                       ///< a recording, whose joints lie beside it
  std::optional<std::filesystem::path> poses, joints, urdf, rig;  ///< where the robot stood; its joints need a robot
  std::optional<std::filesystem::path> time;                      ///< result of `calibrate time`, for `run`
  std::string board, unit = "auto", side = "left";
  bool invert = false;
  int most_views = 40;             ///< of a run
  ArmNames names{"", "", "", {}};  ///< "": as the robot has them
};

/// Adds the options that fill it.
void add_arm_input(Command& command, ArmInput& input);

struct ArmViews {
  HandEyeData data;                                    ///< without poses where there are rows
  std::optional<JointChain> chain;                     ///< of the rows
  std::vector<std::vector<double>> rows;               ///< of each view, where the joints are given
  std::map<std::string, std::filesystem::path> files;  ///< pictures of the views, by name
  std::vector<std::string> images;                     ///< all of them, also those without the board
  std::vector<std::string> notes;
  ArmNames names;  ///< none empty
};

/// Throws InputError: what is missing or stands beside what it excludes, what the readers and finders throw, pictures
/// and joints that do not belong together.
ArmViews read_arm_views(const ArmInput& input);

/// Only the views at `indices`.
ArmViews some_views(const ArmViews& all, const std::vector<std::size_t>& indices);

/// Every fifth view, which the solver shall not see, taken out of `views`.
ArmViews keep_back(ArmViews& views);

/// The robot's poses of all views, with `offsets` (rad or m, by joint) added to the joints where these are given.
HandEyeData with_poses(const ArmViews& views, const std::map<std::string, double>& offsets);

/// The lens of a run's camera, where it has one.
std::optional<CameraModel> lens_of_run(const ArmInput& input);

}  // namespace foresight
