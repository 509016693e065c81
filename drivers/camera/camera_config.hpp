// What a rig file says of its two cameras, and how one is opened from it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "common/clock.hpp"
#include "drivers/camera/camera.hpp"
#include "drivers/camera/stereo_pairing.hpp"
#include "scene/camera_info.hpp"

namespace foresight {

class YamlMap;

enum class CameraDriver : std::uint8_t {
  v4l2,
  libcamera,
  images,  ///< a folder of numbered files
  mock,    ///< the mock lab's (sim/live_view)
};
const char* to_string(CameraDriver driver);

struct CameraConfig {
  CameraDriver driver = CameraDriver::v4l2;
  /// v4l2: a path, "serial:..." or "bus:..."; libcamera: the camera's id or model; images: the folder; mock: empty.
  std::string device;
  CameraSettings settings;  ///< of images only the rate counts
  bool repeat = true;       ///< images: from the first again after the last
  std::optional<CameraInfo> calibration;
};

/// The keys are those of docs/rig-files.md, `cameras`.
struct StereoConfig {
  std::array<CameraConfig, 2> cameras;  ///< index: Side; both of the same rate, both mock or none
  PairingOptions pairing;

  const CameraConfig& camera(Side side) const { return cameras[static_cast<std::size_t>(side)]; }
  bool mock() const { return cameras[0].driver == CameraDriver::mock; }
};

/// Throws InputError naming file, line and field: unknown keys and words with the nearest known one, keys that the
/// driver does not have, one device for both cameras, rates that differ, a tolerance of half a frame period or more, an
/// exposure longer than a period, a size unlike the calibration's, a calibration of the right camera without its place.
StereoConfig read_stereo_config(const YamlMap& map);

/// "libcamera:..." or what v4l2 takes, as command lines give it.
CameraConfig camera_by_name(const std::string& selector);

/// The camera, not yet started. Real drivers and images only: the mock lab's cameras need a world. `clock` must outlive
/// it. Throws InputError (settings that make no sense, no such folder), std::invalid_argument for mock.
std::unique_ptr<Camera> make_camera(std::string name, const CameraConfig& config, Clock& clock);

}  // namespace foresight
