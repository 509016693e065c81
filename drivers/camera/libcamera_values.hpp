// libcamera's formats and controls in our words: names and whole numbers. Private to this module; only in builds with
// libcamera.
#pragma once

#include <libcamera/controls.h>
#include <libcamera/stream.h>

#include "drivers/camera/camera.hpp"

namespace foresight::libcam {

/// libcamera's name of the format. Throws InputError where it is not among those offered, naming what is; `where` names
/// the camera.
libcamera::PixelFormat offered_format(const libcamera::StreamFormats& offered, PixelFormat format,
                                      const std::string& where);
/// "ExposureTime" to "exposure_time"; controls with fractions count thousandths and end in "_milli".
std::string plain_name(const libcamera::ControlId& id);
/// All that are one number, in order of name; their value is that in `set`, else the default.
std::vector<CameraControl> list_controls(const libcamera::ControlInfoMap& known,
                                         const std::map<std::string, std::int64_t>& set);
/// Adds a setting to `list`. Throws InputError (unknown, naming the nearest; out of range); `where` names the camera.
void add_control(libcamera::ControlList& list, const libcamera::ControlInfoMap& known, const std::string& control,
                 std::int64_t value, const std::string& where);

}  // namespace foresight::libcam
