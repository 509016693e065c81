// A file of where the joints were, cycle by cycle.
#pragma once

#include <deque>
#include <filesystem>
#include <fstream>

#include "rig/rig.hpp"
#include "session/joint_tracks.hpp"

namespace foresight {

/// Positions of all joints over time, as --follow and `calibrate` read them: time_s on the robot's clock, then the
/// joints, all of them where they were at that instant. A drive's word may be much older than the cycle in which it is
/// looked at: each joint is interpolated between the instants at which its own drive told its position. One thread.
class JointLog {
 public:
  /// Throws RuntimeFailure where the file cannot be written.
  JointLog(const std::filesystem::path& file, const Rig& rig, BroadcastRing<RobotCycle>::Reader cycles);
  /// A file that nothing could be written to goes.
  ~JointLog();
  JointLog(const JointLog&) = delete;
  JointLog& operator=(const JointLog&) = delete;

  /// Writes a row for the instant of each cycle that came since the last call, once all joints are homed (before, they
  /// tell no position) and have told of it. To be called before the ring comes round.
  void write();
  /// Cycles without a row: not taken from the ring in time, or with a joint that fell silent.
  std::uint64_t dropped() const { return cycles_.dropped() + silent_; }
  /// Why the file is not complete (a full disk); "" where it is.
  std::string fault();

 private:
  void write_row(const JointState& state);

  std::filesystem::path file_;
  std::ofstream stream_;
  BroadcastRing<RobotCycle>::Reader cycles_;
  JointTracks joints_;
  std::deque<RobotTime> waiting_;  // instants of cycles that not all joints have told of
  std::uint64_t silent_ = 0;
};

}  // namespace foresight
