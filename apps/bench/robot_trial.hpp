// A rig with emulated drives and its real gate, a line, and an operator's side that predicts it: in stepped time.
//
//   RandomMotion --set-points--> line down --> gate --> emulated drives
//        |                                        |
//   RobotFuture <--reports------ line up <--------'        what is shown is compared with what was
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "link/line/line_spec.hpp"
#include "prediction/robot_future.hpp"
#include "rig/robot_devices.hpp"

namespace foresight {

struct RobotTrialOptions {
  LineSpec line;
  double seconds = 60;   ///< that are judged, after `learning`
  double learning = 10;  ///< s of motion before
  unsigned seed = 1;     ///< of the motion; the line has its own
  double set_points_hz = 100, pictures_hz = 60;
  std::string tool;  ///< link; empty: the one that the last joint of the arm moves
};

/// Of a way to show the robot: how far the tool was from there, m, of each picture.
struct ShownErrors {
  std::vector<double> tool;
};

struct RobotTrialFigures {
  ShownErrors predicted, hold, velocity, asked;
  std::vector<double> held;        ///< m: as `predicted`, while the gate held the robot back from its target
  std::vector<double> shafts;      ///< m: as `predicted`, by the emulated shafts themselves instead of their encoders
  std::vector<double> rotation;    ///< rad, of the tool
  std::vector<double> joints;      ///< rad, of all joints that turn, pooled
  std::vector<double> pixels;      ///< of the tool, in a camera 1.5 m away of 525 px focal length
  std::vector<double> tool_sigma;  ///< m, as told
  std::size_t tool_inside = 0, joints_inside = 0, joints_judged = 0;  ///< within 2 sigma
  std::size_t pictures = 0, invalid = 0;
  std::string invalid_words;                ///< of the first that was
  double largest_step_share = 0;            ///< of a joint from picture to picture, of what it may go in that time
  double delay_s = 0, delay_sigma_s = 0;    ///< of a set-point, as told at the end
  double cpu_s = 0;                         ///< of the predicting side, all of the time
  double moved_rad = 0, fastest_share = 0;  ///< that the joints went in sum; their largest velocity, of what they may
  std::vector<ResponseFigures> drives;      ///< as learnt at the end, of each joint
  double time_s = 0;                        ///< that was simulated, with the learning
};

/// Who moves the robot in place of RandomMotion, and watches. All are called in stepped time, one after the other.
struct RobotTrialHooks {
  /// What is asked for now, so many seconds after the robot was ready; `start`: where it stood then.
  std::function<JointValues(double seconds, const JointValues& start)> wish;
  /// Every picture, judged or not.
  std::function<void(const RobotDevices&, RobotTime now, const PredictedRobot& shown)> shown;
  std::function<bool()> over;  ///< ends the trial before RobotTrialOptions::seconds are over
};

/// Throws InputError: a rig without a robot's URDF or without the tool, RuntimeFailure: its drives do not come up.
RobotTrialFigures try_robot(const Rig& rig, const RobotTrialOptions& options, const RobotTrialHooks& hooks = {});

}  // namespace foresight
