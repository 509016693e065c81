// Poses and fields of view as OpenXR has them, and as we do (eye_geometry.hpp).
#pragma once

#include <optional>

#include "display/head/eye_geometry.hpp"
#include "display/head/xr_calls.hpp"

namespace foresight::head {

/// checked_pose() of it.
std::optional<Pose> pose_of(const XrPosef& pose);
XrPosef xr_pose(const Pose& T);

/// checked_fov() of it.
std::optional<EyeFov> fov_of(const XrFovf& fov);
XrFovf xr_fov(const EyeFov& fov);

}  // namespace foresight::head
