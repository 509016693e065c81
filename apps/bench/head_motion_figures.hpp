// How far off what an eye sees is, where the head has gone on since it was drawn.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/bench/head_lab.hpp"
#include "scene/pose_track.hpp"

namespace foresight {

/// A head that looks and leans about, for who has no recording: 20 s.
PoseTrack swaying_head();

/// Where it is after `t` s. Axes as recordings have them: x to the right, y up.
Pose swayed(double t);

/// Views drawn where a recorded head was 50 ms before (axes of the recording: x to the right, y up), shown where it is:
/// as they are, turned, and warped by depth. Error of a pixel: how far from where the right surface is seen in the
/// drawn view the pixel is taken, px. Prints p50 and p95; keys: unwarped, turned, warped.
nlohmann::json head_motion_figures(HeadLab& lab, const PoseTrack& head, int width, int height);

/// So many frames of a recorded head at 10 Hz, turning on the spot or as it moved: how many frames need no new face of
/// display/warp/cube_views.hpp, what frames and faces cost beside drawing each frame, and decibels against that;
/// without and with shells of distance, and with images that come, each of which changes what faces show. Prints them;
/// keys: turning, moving, moving_in_shells, turning_with_images, turning_with_images_in_shells.
nlohmann::json cube_figures(HeadLab& lab, const PoseTrack& head, int width, int height, int frames);

}  // namespace foresight
