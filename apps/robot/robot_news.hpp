// What changes in what a robot does, as lines of a log.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "drivers/robot/robot_words.hpp"

namespace foresight {

/// One thread.
class RobotNews {
 public:
  explicit RobotNews(std::vector<JointWords> joints) : joints_(std::move(joints)) {}

  /// What an operator is called while it is in charge: "the file".
  void name(std::uint64_t operator_id, const std::string& words) { names_[operator_id] = words; }
  /// "2026-11-30T12:00:00.250Z: stopped: the way is ...", where the phase, the reason of it, who is in charge or who
  /// stopped it has changed since the last call; else "". What holds a robot back that is still following is none of
  /// it. `now`: the instant that the line says, in UTC. `line_stopper`: of who_stopped().
  std::string of(const RobotStatus& status, std::chrono::system_clock::time_point now,
                 const std::string& line_stopper = "");

 private:
  struct Doing {
    RobotPhase phase = RobotPhase::disabled;
    GateReason reason = GateReason::none;
    int joint = -1;
    std::uint64_t operator_id = 0;
    std::string stopped_by;
    bool operator==(const Doing&) const = default;
  };
  static Doing doing(const RobotStatus& status, const std::string& line_stopper);

  std::vector<JointWords> joints_;
  std::map<std::uint64_t, std::string> names_;
  Doing last_;
};

}  // namespace foresight
