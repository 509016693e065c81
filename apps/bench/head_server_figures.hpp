// From a head's pose to its picture, while the scene is drawn and textures are extracted beside it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/bench/drawing_process.hpp"
#include "apps/bench/head_lab.hpp"
#include "display/head/eye_warper.hpp"

namespace foresight {

/// Where views are drawn that frames are warped from.
enum class DrawnBy { thread, showing_thread, process };

struct HeadServerTrial {
  int width = 640, height = 480;  ///< px of each eye
  double rate_hz = 20;            ///< of stereo frames
  double seconds = 12;            ///< in the midst of which no image comes for 5 s, or as long as half of it
  head::SecondEyeFrom second = head::SecondEyeFrom::own_view;
  DrawnBy drawn_by = DrawnBy::thread;
  DrawingProcess* process = nullptr;  ///< where that draws: images come to it all the time
};

/// In real time, frames as in a head display without its runtime: the head's pose (a sway of some cm and degrees) is
/// taken when a frame's interval begins, both eyes are warped from the newest views and copied to where they would be
/// shown. The run's images come at 5 Hz. Prints, and gives: how long that took (`pose_to_swap_ms`: p50, p99),
/// `frames_hz`, `scene_hz`, `late` frames, CPU-ms of a frame, and what it missed. Throws RuntimeFailure where no views
/// come.
nlohmann::json head_server_figures(HeadLab& lab, gl::Context& context, const HeadServerTrial& trial);

}  // namespace foresight
