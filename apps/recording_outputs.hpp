// What recordings of a robot and its cameras write.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/command_line/path_roles.hpp"

namespace foresight {

/// `record OUT`: the run, and its joints beside it.
std::vector<Output> recording_outputs(const std::filesystem::path& out);
/// `robot --record OUT`: with the logs of the buses.
std::vector<Output> robot_recording_outputs(const std::filesystem::path& out);
/// `robot --log FILE`: FILE, or a log a bus (RobotDeviceOptions::log), of which those that are there count.
std::vector<Output> can_log_outputs(const std::filesystem::path& file);

}  // namespace foresight
