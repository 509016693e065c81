// Both sides of a line in one process and in stepped time: a mock rig that is served, and whatever an operator's side
// is.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/clock.hpp"
#include "link/config/own_domain.hpp"
#include "link/dds/pretended_line.hpp"
#include "link/operator_side/operator_end.hpp"
#include "link/robot_side/robot_server.hpp"
#include "rig/robot_devices.hpp"
#include "session/robot_cameras.hpp"

namespace foresight {

/// The robot's side, with mock drives and mock cameras: all of `foresight robot --serve` but its console. One thread.
///
/// Its host has a clock of its own. At first that is `clock`; a program that is started again has one that began anew.
class SteppedRobotSide {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds(10);  ///< as the console's

  /// `physics`: things can be grasped; its seed; `layout`: sim::task_layout(). `clock` and `rig` must outlive this.
  /// Throws what its parts do.
  SteppedRobotSide(const Rig& rig, const std::filesystem::path& file, SteppedClock& clock, const LineSpec& line,
                   std::optional<unsigned> physics = std::nullopt, unsigned layout = 0);
  ~SteppedRobotSide();

  /// One cycle of the control loop; time passes until it is due.
  void cycle();
  link::Participant& participant() { return participant_; }
  /// Of the program that runs.
  Robot& robot();
  RobotDevices& devices();
  RobotCameras& cameras();
  const Rig& rig() const { return rig_; }
  /// Of the first one.
  const Identity& identity() const { return identity_; }
  /// To try faults: no images are taken; the program does nothing but its control loop.
  void hold_cameras(bool held) { cameras_held_ = held; }
  void hold_program(bool held) { program_held_ = held; }
  /// Likewise: it is gone at once, and its drives and cameras with it; or is there again, of that rig, as a host that
  /// has just been switched on. That may take seconds of this machine's time, and none of `clock`.
  void end();
  void start(const Rig& rig, const Identity& identity);
  bool runs() const { return program_ != nullptr; }
  unsigned starts() const { return starts_; }

 private:
  struct Program;
  const Rig& rig_;
  SteppedClock& clock_;
  Identity identity_;
  std::shared_ptr<link::PretendedLine> line_;
  link::OwnDomain domain_;
  link::Participant participant_;
  std::optional<unsigned> physics_;
  unsigned layout_, starts_ = 0;
  bool cameras_held_ = false, program_held_ = false;
  std::unique_ptr<Program> program_;  // while it runs
  Duration period_;
  RobotTime next_;  // by `clock`
};

}  // namespace foresight
