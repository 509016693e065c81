// A robot arm from a URDF, for calibrations that start from joint angles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/robot/hand_eye.hpp"
#include "scene/urdf_reader.hpp"

namespace foresight {

struct JointChain {
  UrdfRobot robot;
  int base = 0, flange = 0;  ///< links
  std::vector<int> joints;   ///< from base to flange, those that move and follow no other
};

/// `base`, `flange`: names of links; empty: the root, and the first link with all the turning
/// joints of the longest chain above it.
/// Throws InputError: no such link (with the nearest), no chain between the two, none that moves.
JointChain read_joint_chain(const std::filesystem::path& urdf, const std::string& base, const std::string& flange);

/// The same of a robot that was read; `urdf`: the file, for messages.
JointChain joint_chain_of(UrdfRobot robot, const std::string& base, const std::string& flange,
                          const std::filesystem::path& urdf);

/// Forward kinematics. Throws InputError at `where` for another number of positions, or one outside of its limits.
Pose flange_pose(JointChain& chain, const std::vector<double>& positions, const std::string& where);

/// Pose at `positions` + `offsets`, with its change per offset. The first and the last joint have
/// none: a shift of theirs moves the base or the board, and no image tells the two apart.
RobotPose jointed_pose(JointChain& chain, const std::vector<double>& positions, const std::vector<double>& offsets,
                       const std::string& where);

/// Hand-eye with the joints' zero offsets (of chain.joints, 0 for the first and last), linearised
/// anew until they settle. `data.poses` is filled from `rows`, one per view.
HandEyeSummary solve_with_joints(JointChain& chain, const std::vector<std::vector<double>>& rows, HandEyeData data,
                                 const HandEyeOptions& options);

}  // namespace foresight
