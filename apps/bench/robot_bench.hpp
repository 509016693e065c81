// `foresight bench robot`: how punctual the control loop is, and what it costs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

struct RobotBenchOptions {
  std::string rig;
  double seconds = 60;
  std::optional<std::filesystem::path> json;
};

/// Moves a rig with emulated drives on in-process buses in real time. Prints overruns, the lateness of wake-ups beside
/// that of an empty loop of the same rate in the same run, and the CPU time of the loop's thread, of the emulated
/// drives and of all. Returns 1 where the robot did not follow to the end, else 0.
int bench_robot(const RobotBenchOptions& options);

}  // namespace foresight
