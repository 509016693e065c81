// Set-up of a V4L2 capture device: finding it, its format, its controls. Private to this module, and to its tests.
#pragma once

#include <linux/videodev2.h>

#include <optional>

#include "drivers/camera/camera.hpp"
#include "drivers/camera/v4l2_calls.hpp"

namespace foresight::v4l2 {

/// An open device; capability and identity were checked. Single-planar capture only.
struct Device {
  std::string path;
  UniqueFd fd;
};

/// `selector`: "/dev/video0" (or a link to it), "serial:<USB serial>", "bus:<bus info>" (as in VIDIOC_QUERYCAP).
/// Nothing where no such device is there now. Throws InputError (not a selector, not a capture device) or
/// RuntimeFailure (may not be opened).
std::optional<Device> find_device(Calls& calls, const std::string& selector, const std::string& camera);
/// "/dev/video0 (bus:..., serial:...)" of all capture devices, for messages.
std::string list_devices(Calls& calls);

struct Format {
  std::size_t stride = 0, size = 0;  ///< bytes, per row and at most per frame
  double rate = 0;                   ///< in effect
};
/// Sets format, size and rate. Throws InputError where the camera has no such format or size, naming what it has.
Format set_format(Calls& calls, const Device& device, const CameraSettings& settings, const std::string& camera);
std::optional<std::uint32_t> fourcc(PixelFormat format);

std::vector<CameraControl> list_controls(Calls& calls, const Device& device);
/// Throws as Camera::set_control(). False: a button was pressed (with 0), and no value stays.
bool set_control(Calls& calls, const Device& device, const std::string& control, std::int64_t value,
                 const std::string& camera);
/// Fixes the exposure, ending the automatic one. Throws InputError where the camera has no such control or does not do
/// that time (more than a tenth away), naming the nearest.
void set_exposure(Calls& calls, const Device& device, Duration exposure, const std::string& camera);
/// Of V4L2_CID_EXPOSURE_ABSOLUTE; nothing where the device has none.
std::optional<Duration> exposure(Calls& calls, int fd) noexcept;

/// " failed: Invalid argument (errno 22)"
std::string errno_text(int error);

}  // namespace foresight::v4l2
