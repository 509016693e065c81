#include "drivers/camera/camera_config.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/camera/image_folder_camera.hpp"
#include "drivers/camera/libcamera_camera.hpp"
#include "drivers/camera/v4l2_camera.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

constexpr const char* kNames[] = {"v4l2", "libcamera", "images", "mock"};  // index: CameraDriver
constexpr const char* kLibcamera = "libcamera:";

// A key that this driver has no use for is a misunderstanding, not decoration.
void refuse(const YamlMap& map, CameraDriver driver, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (map.has(key))
      throw InputError(map.where(key),
                       std::string("is nothing that a camera of the driver '") + to_string(driver) + "' has",
                       "remove it");
}

std::string read_device(const YamlMap& map, CameraDriver driver) {
  if (driver == CameraDriver::mock) {
    refuse(map, driver, {"device", "serial"});
    return "";
  }
  if (driver != CameraDriver::v4l2) refuse(map, driver, {"serial"});
  if (map.has("device") && map.has("serial"))
    throw InputError(map.where("serial"), "stands beside a device", "keep one of the two");
  if (map.has("serial")) return "serial:" + map.text("serial");
  if (!map.has("device") && driver == CameraDriver::v4l2)
    throw InputError(map.where("device"), "is missing, and serial too",
                     "say which camera: `foresight doctor` lists them");
  const std::string device = map.text("device");
  if (driver == CameraDriver::images) return (map.file().parent_path() / device).string();
  return device;
}

void read_size(const YamlMap& map, CameraConfig& out) {
  if (map.has("size_px")) {
    const auto size = map.numbers("size_px", 2);
    for (const double n : size)
      if (n != std::floor(n) || n < 1 || n > 16384)
        throw InputError(map.where("size_px"), "is no size", "give [width, height], whole numbers from 1 to 16384");
    out.settings.width = static_cast<int>(size[0]);
    out.settings.height = static_cast<int>(size[1]);
  }
  if (!map.has("lens")) return;
  const auto file = map.file().parent_path() / map.text("lens");
  if (!std::filesystem::is_regular_file(file))
    throw InputError(map.where("lens"), "there is no file " + file.string(),
                     "give the camera's calibration (camera.yaml), relative to the rig file");
  out.calibration = read_camera_info(file);
  const Lens& lens = out.calibration->lens;
  const auto size = [](int w, int h) { return std::to_string(w) + " x " + std::to_string(h); };
  if (map.has("size_px") && (lens.width() != out.settings.width || lens.height() != out.settings.height))
    throw InputError(map.where("size_px"),
                     "is " + size(out.settings.width, out.settings.height) + ", but the lens was calibrated at " +
                         size(lens.width(), lens.height()),
                     "use that size, or calibrate anew");
  out.settings.width = lens.width();
  out.settings.height = lens.height();
}

Duration read_span(const YamlMap& map, const char* key, double period) {
  const double value = map.positive(key);
  if (value > period)
    throw InputError(map.where(key), "is " + std::to_string(value) + " s, longer than a frame period",
                     "give seconds, at most " + std::to_string(period));
  return seconds(value);
}

CameraConfig read_camera(const YamlMap& map) {
  map.require_known(
      {"driver", "device", "serial", "format", "size_px", "rate_hz", "exposure_s", "readout_s", "controls", "lens"});
  CameraConfig out;
  out.driver = map.choice<CameraDriver>("driver", {{kNames[0], CameraDriver::v4l2},
                                                   {kNames[1], CameraDriver::libcamera},
                                                   {kNames[2], CameraDriver::images},
                                                   {kNames[3], CameraDriver::mock}});
  out.device = read_device(map, out.driver);
  if (out.driver == CameraDriver::images)
    refuse(map, out.driver, {"format", "size_px", "exposure_s", "readout_s", "controls"});
  if (out.driver == CameraDriver::mock) refuse(map, out.driver, {"readout_s"});
  if (map.has("rate_hz")) out.settings.rate = map.positive("rate_hz");
  if (out.settings.rate > 1000)
    throw InputError(map.where("rate_hz"), "is " + std::to_string(out.settings.rate), "give at most 1000");
  if (map.has("format")) out.settings.format = parse_pixel_format(map.text("format"), map.where("format"));
  if (out.driver == CameraDriver::mock && out.settings.format != PixelFormat::yuyv)
    throw InputError(map.where("format"), "the mock lab's cameras have no other than yuyv", "remove it");
  read_size(map, out);
  if (out.driver == CameraDriver::mock && out.settings.width % 2 != 0)
    throw InputError(map.where("size_px"), "has an odd width, which yuyv cannot have", "take an even one");
  const double period = 1 / out.settings.rate;
  if (map.has("exposure_s")) out.settings.exposure = read_span(map, "exposure_s", period);
  if (map.has("readout_s")) out.settings.readout = read_span(map, "readout_s", period);
  if (!map.has("controls")) return out;
  const YamlMap controls = map.map("controls");
  controls.require_known(controls.keys());  // none twice; which there are, the camera knows
  for (const std::string& key : controls.keys()) out.settings.controls[key] = controls.integer(key);
  return out;
}

void check_both(const YamlMap& map, const StereoConfig& both) {
  const auto& [left, right] = both.cameras;
  if (left.driver == right.driver && left.device == right.device && left.driver != CameraDriver::mock)
    throw InputError(map.where("right"), "is the same device as the left camera, " + in_quotes(left.device),
                     "give each its own");
  if ((left.driver == CameraDriver::mock) != (right.driver == CameraDriver::mock))
    throw InputError(map.where("right"), "is mock or real unlike the left camera, which sees another world",
                     "choose one kind for both");
  if (left.settings.rate != right.settings.rate)
    throw InputError(map.where("right"), "has another rate_hz than the left camera: their images would not pair",
                     "give both the same");
  if (both.mock() && (left.settings.width != right.settings.width || left.settings.height != right.settings.height))
    throw InputError(map.where("right"), "has another size than the left camera, which mock cameras cannot",
                     "give both the same");
  if (right.calibration && !right.calibration->T_left_right)
    throw InputError(map.where("right"), "its lens file has no T_left_right", "say there where the right camera is");
}

}  // namespace

const char* to_string(CameraDriver driver) {
  return kNames[static_cast<std::size_t>(driver)];
}

StereoConfig read_stereo_config(const YamlMap& map) {
  map.require_known({"left", "right", "pairing_tolerance_s"});
  StereoConfig out;
  out.cameras = {read_camera(map.map("left")), read_camera(map.map("right"))};
  check_both(map, out);
  const double half_period = 0.5 / out.cameras[0].settings.rate;
  out.pairing.tolerance = std::min(out.pairing.tolerance, seconds(0.45 / out.cameras[0].settings.rate));
  if (!map.has("pairing_tolerance_s")) return out;
  const double tolerance = map.positive("pairing_tolerance_s");
  if (tolerance >= half_period)
    throw InputError(map.where("pairing_tolerance_s"),
                     "is " + std::to_string(tolerance) + " s: an image could pair with two others",
                     "give less than half a frame period, " + std::to_string(half_period) + " s");
  out.pairing.tolerance = seconds(tolerance);
  return out;
}

CameraConfig camera_by_name(const std::string& selector) {
  CameraConfig out;
  if (selector.starts_with(kLibcamera)) out.driver = CameraDriver::libcamera;
  out.device = out.driver == CameraDriver::libcamera ? selector.substr(std::string_view(kLibcamera).size()) : selector;
  return out;
}

std::unique_ptr<Camera> make_camera(std::string name, const CameraConfig& config, Clock& clock) {
  switch (config.driver) {
    case CameraDriver::v4l2: {
      V4l2Camera::Options options;
      options.device = config.device;
      options.settings = config.settings;
      // At low rates a second is no hang.
      options.hangs_after = std::max(options.hangs_after, seconds(3 / config.settings.rate));
      return std::make_unique<V4l2Camera>(std::move(name), options, clock);
    }
    case CameraDriver::images:
      return std::make_unique<ImageFolderCamera>(
          std::move(name), config.device,
          ImageFolderCamera::Options{.prefix = "", .rate = config.settings.rate, .repeat = config.repeat}, clock);
    case CameraDriver::libcamera: {
      LibcameraCamera::Options options;
      options.device = config.device;
      options.settings = config.settings;
      options.hangs_after = std::max(options.hangs_after, seconds(3 / config.settings.rate));
      return std::make_unique<LibcameraCamera>(std::move(name), options, clock);
    }
    case CameraDriver::mock: break;
  }
  throw std::invalid_argument("a mock camera needs a world");
}

}  // namespace foresight
