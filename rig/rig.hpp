// The rig file: which devices a lab has, how they are wired and what they may do.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/camera_config.hpp"
#include "drivers/drive/drive.hpp"
#include "drivers/robot/robot_words.hpp"
#include "drivers/robot/safety_gate.hpp"
#include "link/config/link_config.hpp"
#include "scene/urdf_reader.hpp"

namespace foresight {

enum class JointGroup : std::uint8_t { arm, gripper, pan_tilt };
const char* to_string(JointGroup group);

enum class DriveProtocol : std::uint8_t { powercube, cia402 };

struct RigBus {
  std::string name;       ///< by which joints refer to it
  std::string interface;  ///< "can0"; "mock": emulated drives inside of the process
  DriveProtocol protocol = DriveProtocol::cia402;
  int bit_rate = 1'000'000;  ///< bit/s: 10,000 .. 1,000,000
};

struct RigJoint {
  JointGroup group = JointGroup::arm;
  std::string unit;     ///< "rad" or "m": that of all its numbers
  std::size_t bus = 0;  ///< index into Rig::buses
  DriveConfig drive;
  double jerk = 0;             ///< unit/s^3; > 0
  double following_error = 0;  ///< unit; > 0
  /// How its drive follows set-points, where that was measured: `foresight bench prediction robot` tells it.
  struct Response {
    double dead_time_s = 0, lag_s = 0;  ///< s; >= 0
    double sigma_s = 0;                 ///< s: standard deviation of their sum; > 0
  };
  std::optional<Response> response = {};
  std::optional<double> start = {};  ///< unit: where a person begins to work, within the joint's range
  int homing_method = 0;             ///< CiA 402, object 6098h; 0: none
  bool absolute = false;             ///< CiA 402: its encoder knows the position from power-on, it needs no homing
};

/// Results of `foresight calibrate`; whoever uses them reads them.
struct RigCalibration {
  std::optional<std::filesystem::path> pan_tilt;  ///< kind "pan-tilt"; without it, no image has a pose by the encoders
  std::optional<std::filesystem::path> time;      ///< kind "time"; only beside pan_tilt
  std::optional<std::filesystem::path> tags;      ///< map of tags that stand still: rows id corner x y z
  std::optional<std::filesystem::path> photometric =
      {};  ///< kind "photometric": corners of tags are found in the light
};

struct Rig {
  std::string name;
  std::optional<UrdfRobot> robot;  ///< without it, nothing is checked against the surroundings
  Pose T_world_robot = Pose::Identity();
  double rate_hz = 250, command_age_s = 0.1, feedback_age_s = 0.05, ramp_s = 2;
  Surroundings surroundings;
  std::vector<RigBus> buses;
  std::vector<RigJoint> joints;                ///< in the order of the file, which is that of commands
  std::optional<std::filesystem::path> scene;  ///< what stands around, but for the robot (scene/scene_reader.hpp)
  std::optional<StereoConfig> cameras;
  std::optional<RigCalibration> calibration;
  LinkConfig link;

  /// What the safety gate needs of all that.
  GateOptions gate_options() const;
  std::vector<std::string> joint_names() const;
  /// The same, "" for a joint that is not the URDF's; all of them where there is none.
  std::vector<std::string> urdf_joint_names() const;
  /// Names and units, for messages.
  std::vector<JointWords> joint_words() const;
  /// The robot's body, or null where the rig has none.
  std::unique_ptr<RobotShape> shape() const;
};

/// Reads and checks a rig file (docs/rig-files.md). Throws InputError naming file, line and field: unknown keys with
/// the nearest known one, a missing unit, limits that contradict each other, a node id used twice on a bus, joints that
/// the URDF does not have or that it has and the file does not, and what read_stereo_config() refuses.
Rig read_rig(const std::filesystem::path& file);

}  // namespace foresight
