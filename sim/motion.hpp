// How the camera and the plate of the sample run move. Smooth, endless, the same every time.
#pragma once

#include "scene/scene_model.hpp"

namespace foresight::sim {

/// A hand-held camera that sways around the table. `t` in seconds from the start.
Pose T_world_camera_at(double t);

/// The plate slides and turns on the table.
Pose T_world_plate_at(double t);

/// Right camera of the stereo rig in the left camera's frame: 65 mm to the right, slightly toed in.
Pose T_left_right();

}  // namespace foresight::sim
