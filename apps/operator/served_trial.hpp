// The operator who is a program, at a line to a robot's program of its own, in real time.
//
// It has the line and nothing else: what the camera saw at a shown instant is known when that image has come, as the
// line's coding left it, and the thing is where the seat believes it to be; it is in the tray once images show it
// there.
#pragma once

#include "apps/operator/seat_trial.hpp"

namespace foresight {

struct ServedTrialOptions {
  std::filesystem::path rig_file;
  std::string name = "the operator's program";
  std::optional<LineSpec> line;  ///< that everything passes besides the network
  bool things = false;           ///< the robot's side is the mock lab with physics
  std::string thing, tray;       ///< with things: the thing shall end in the tray
  double most_s = 120;           ///< of motion
  double found_within_s = 60;    ///< the robot has to be driven within that time
  double pictures_hz = 5;        ///< at most
  TrustSwitchOptions fall_back;  ///< of the view that would be shown
  TextureOptions textures = kSeatTextures;
  std::optional<LevelSettings> levels;       ///< ViewSetup::levels
  std::optional<std::filesystem::path> out;  ///< folder for shown/, delayed/, true/
};

/// As try_seat(). Figures without a line are not measured.
SeatTrialFigures try_served_seat(const Rig& rig, std::shared_ptr<const LiveScene> scene,
                                 const ServedTrialOptions& options, ScriptedMotion& motion,
                                 const std::function<bool()>& stopped,
                                 const std::function<void(const std::string&)>& say);

}  // namespace foresight
