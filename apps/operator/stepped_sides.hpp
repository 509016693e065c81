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
  Robot& robot() { return *robot_; }
  RobotDevices& devices() { return devices_; }
  RobotCameras& cameras() { return *cameras_; }
  const Identity& identity() const { return identity_; }
  /// To try faults: no images are taken; the program does nothing but its control loop.
  void hold_cameras(bool held) { cameras_held_ = held; }
  void hold_program(bool held) { program_held_ = held; }

 private:
  const Rig& rig_;
  SteppedClock& clock_;
  Identity identity_;
  std::shared_ptr<link::PretendedLine> line_;
  link::OwnDomain domain_;
  link::Participant participant_;
  RobotDevices devices_;
  std::unique_ptr<RobotShape> shape_;
  std::unique_ptr<Robot> robot_;
  std::unique_ptr<RobotCameras> cameras_;
  std::unique_ptr<link::RobotServer> server_;
  Duration period_;
  RobotTime next_;
  bool cameras_held_ = false, program_held_ = false;
};

}  // namespace foresight
