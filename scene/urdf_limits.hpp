// Limits of a URDF's joints that are not in the joint's own <limit>.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/urdf_reader.hpp"

namespace foresight {

/// rad or m; lower is below upper.
struct SoftLimits {
  double lower = 0, upper = 0;
};

/// Of each joint whose <safety_controller> gives a range, by name: within it nothing holds the joint back. `file`: one
/// that read_urdf() has read.
std::map<std::string, SoftLimits> read_soft_limits(const std::filesystem::path& file);

/// Joint `index`, which follows no other, with limits and velocity cut such that all that follow it keep within theirs.
/// Its lower limit is not below the upper one where these leave it nothing.
UrdfJoint within_followers(const UrdfRobot& robot, std::size_t index);

}  // namespace foresight
