// A file of where the joints were, cycle by cycle.
#pragma once

#include <filesystem>
#include <fstream>

#include "drivers/robot/robot.hpp"
#include "rig/rig.hpp"

namespace foresight {

/// Positions of all joints over time, as --follow and `calibrate` read them: time_s of the cycle, then a column for
/// each joint, then for each of them its own instant, NAME_time_s: a position may be much older than the cycle in which
/// it was looked at. All on the robot's clock. One thread.
class JointLog {
 public:
  /// Throws RuntimeFailure where the file cannot be written.
  JointLog(const std::filesystem::path& file, const Rig& rig, BroadcastRing<RobotCycle>::Reader cycles);

  /// Writes every cycle since the last call, once all joints are homed: before, they tell no position. The ring holds
  /// kCyclesKept.
  void write();
  std::uint64_t dropped() const { return cycles_.dropped(); }  ///< cycles that were not written in time

 private:
  std::ofstream stream_;
  BroadcastRing<RobotCycle>::Reader cycles_;
};

}  // namespace foresight
