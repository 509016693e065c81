// An operator who is a program at a seat, both sides in stepped time: what he is shown for each instant, against what
// the robot's camera saw then.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/operator/seat_measures.hpp"
#include "link/line/line_spec.hpp"
#include "link/operator_side/operator_end.hpp"
#include "rig/rig.hpp"
#include "scene/lod/level_director.hpp"
#include "seat/scripted_driver.hpp"
#include "seat/seat_textures.hpp"
#include "seat/task_watch.hpp"
#include "seat/trust_switch.hpp"
#include "session/live_scene.hpp"

namespace foresight {

class PredictedSource;
class Seat;
class SteppedRobotSide;

/// What goes on in a trial, for who looks on, or makes faults.
struct SeatMoment {
  RobotTime now;
  SteppedRobotSide& robot;
  link::OperatorEnd& end;
  const Seat& seat;
  const PredictedSource& source;
  std::uint64_t pictures = 0;       ///< that were drawn so far
  std::uint64_t texture_bytes = 0;  ///< ExtractionReport::bytes_reserved, of the newest image
};

struct SeatTrialOptions {
  std::filesystem::path rig_file;
  LineSpec line;
  double delay_s = 0;               ///< each way, for the report
  std::optional<unsigned> physics;  ///< things can be grasped: its seed
  unsigned layout = 0;              ///< of things: sim::task_layout()
  std::string thing, tray;          ///< with physics: the thing shall end in the tray
  unsigned seed = 1;
  double most_s = 120;     ///< of motion
  double pictures_hz = 5;  ///< that are measured, at most
  TrustSwitchOptions fall_back;
  /// Pictures are of the instants of the robot's own images, and are compared with these. Else the robot's program may
  /// be started again meanwhile.
  bool scored = true;
  bool zero_delay = true;  ///< with `scored`, also draws each view as it would be without a line
  TextureOptions textures = kSeatTextures;
  std::optional<LevelSettings> levels;       ///< ViewSetup::levels
  std::optional<std::filesystem::path> out;  ///< folder for shown/, delayed/, true/
  /// What the camera saw, as it is to be scored; none: as it was. The operator does not know it.
  std::function<cv::Mat(const cv::Mat&)> truth;
  /// Is told all that the operator asks for.
  std::function<void(OperatorTime, const SeatWish&)> asked;
  /// What is sent in place of what the program means to do: for a program whose hand is at a device. None: what it
  /// means.
  std::function<SeatWish(const SeatView&, const SeatWish& meant)> hand;
  /// After each cycle of the robot, in the trial's thread.
  std::function<void(const SeatMoment&)> each;
  /// Asked every 5 ms: the operator's program stands still.
  std::function<bool()> stands_still;
  int most_losses = ScriptedDriverOptions{}.most_losses;  ///< of the robot, that the program goes on after
};

struct SeatTrialFigures {
  TaskOutcome task;
  /// Whether images have shown the operator's side that the thing lies in the tray, where it cannot know the truth;
  /// nothing without things.
  std::optional<bool> seen_in_tray;
  double delay_s = 0;     ///< measured: of what is commanded
  double joints_p95 = 0;  ///< of what was shown, rad or m
  int losses = 0;
  link::LineFigures line;
  SeatFidelity fidelity;  ///< of the pictures that were shown while the robot was driven
};

/// `rig` is mock. `scene`: what the operator's side knows. Throws what its parts do. `say`: progress, now and then.
SeatTrialFigures try_seat(const Rig& rig, std::shared_ptr<const LiveScene> scene, const SeatTrialOptions& options,
                          ScriptedMotion& motion, const std::function<bool()>& stopped,
                          const std::function<void(const std::string&)>& say);

}  // namespace foresight
