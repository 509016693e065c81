// A seat at a real line: threads, window, devices.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rig/rig.hpp"
#include "scene/lod/level_director.hpp"
#include "seat/seat_textures.hpp"
#include "seat/view_trust.hpp"

namespace foresight {

/// Where the view is shown, beside the window.
enum class HeadDisplayKind { none, openxr, side_by_side };

struct LiveSeatOptions {
  std::filesystem::path rig_file;
  std::string name;                           ///< of the operator, as the robot's side shows it
  std::optional<std::filesystem::path> line;  ///< that everything passes, to try things out
  std::optional<std::filesystem::path> scene;
  bool mock_cameras = false;  ///< the robot's are the mock lab's, whatever the rig says
  bool physics = false;       ///< that lab has things that can be grasped: RobotCameraOptions::physics and layout
  unsigned layout = 0;
  std::string device;  ///< beside keyboard and mouse: as open_tracker() takes it; "" none
  HeadDisplayKind head_display = HeadDisplayKind::none;
  bool second_eye_of_first = false;                   ///< of openxr: head::SecondEyeFrom
  std::vector<std::filesystem::path> display_lenses;  ///< of side_by_side: for both eyes, or left and right; or none
  double rate_hz = 30;
  double font_scale = 1;
  bool sounds = true;  ///< of what happens
  TextureOptions textures = kSeatTextures;
  std::optional<LevelSettings> levels;  ///< ViewSetup::levels
  ViewTrustOptions trust;
};

/// Until somebody closes the window. The exit code. Throws what its parts do.
int run_live_seat(const Rig& rig, const LiveSeatOptions& options);

}  // namespace foresight
