#include "drivers/camera/v4l2_device.hpp"

#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight::v4l2 {
namespace {

constexpr struct {
  PixelFormat format;
  std::uint32_t fourcc;
} kFormats[] = {
    {PixelFormat::yuyv, V4L2_PIX_FMT_YUYV},
    {PixelFormat::nv12, V4L2_PIX_FMT_NV12},
    {PixelFormat::mjpeg, V4L2_PIX_FMT_MJPEG},
    {PixelFormat::mjpeg, V4L2_PIX_FMT_JPEG},
    {PixelFormat::grey, V4L2_PIX_FMT_GREY},
    {PixelFormat::bayer_rggb8, V4L2_PIX_FMT_SRGGB8},
    {PixelFormat::bayer_bggr8, V4L2_PIX_FMT_SBGGR8},
    {PixelFormat::bayer_gbrg8, V4L2_PIX_FMT_SGBRG8},
    {PixelFormat::bayer_grbg8, V4L2_PIX_FMT_SGRBG8},
    {PixelFormat::bayer_rggb10, V4L2_PIX_FMT_SRGGB10},
    {PixelFormat::bayer_bggr10, V4L2_PIX_FMT_SBGGR10},
    {PixelFormat::bayer_gbrg10, V4L2_PIX_FMT_SGBRG10},
    {PixelFormat::bayer_grbg10, V4L2_PIX_FMT_SGRBG10},
    {PixelFormat::bgr, V4L2_PIX_FMT_BGR24},
};

constexpr double kExposureUnit = 1e-4;  // seconds, of V4L2_CID_EXPOSURE_ABSOLUTE

template <std::size_t N>
std::string text_of(const __u8 (&field)[N]) {
  const char* begin = reinterpret_cast<const char*>(field);
  return {begin, strnlen(begin, N)};
}

bool captures(Calls& calls, int fd, v4l2_capability& cap) {
  cap = {};
  if (calls.ioctl(fd, VIDIOC_QUERYCAP, &cap) != 0) return false;
  const auto bits = (cap.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? cap.device_caps : cap.capabilities;
  return (bits & V4L2_CAP_VIDEO_CAPTURE) != 0 && (bits & V4L2_CAP_STREAMING) != 0;
}

std::string names_of_formats(Calls& calls, int fd) {
  std::string out;
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; calls.ioctl(fd, VIDIOC_ENUM_FMT, &description) == 0; ++description.index)
    for (const auto& row : kFormats)
      if (row.fourcc == description.pixelformat) out += (out.empty() ? "" : ", ") + std::string(to_string(row.format));
  return out.empty() ? "none that we know" : out;
}

std::uint32_t offered_fourcc(Calls& calls, int fd, PixelFormat format, const std::string& where) {
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; calls.ioctl(fd, VIDIOC_ENUM_FMT, &description) == 0; ++description.index)
    for (const auto& row : kFormats)
      if (row.format == format && row.fourcc == description.pixelformat) return row.fourcc;
  throw InputError(where, std::string("it has no format ") + to_string(format),
                   "choose one that it has: " + names_of_formats(calls, fd));
}

double set_rate(Calls& calls, int fd, double rate) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  parameters.parm.capture.timeperframe = {1000, static_cast<__u32>(std::lround(rate * 1000))};
  // Cameras with one fixed rate have no such call; then the wanted rate is our best knowledge.
  if (calls.ioctl(fd, VIDIOC_S_PARM, &parameters) != 0) return rate;
  const v4l2_fract period = parameters.parm.capture.timeperframe;
  return period.numerator > 0 ? double(period.denominator) / period.numerator : rate;
}

/// "Exposure Time, Absolute" to "exposure_time_absolute", as v4l2-ctl does.
std::string plain_name(const std::string& name) {
  std::string out;
  for (char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!out.empty() && out.back() != '_')
      out += '_';
  }
  if (!out.empty() && out.back() == '_') out.pop_back();
  return out;
}

template <typename Use>
void for_each_control(Calls& calls, int fd, Use use) {
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  for (; calls.ioctl(fd, VIDIOC_QUERYCTRL, &query) == 0; query.id |= V4L2_CTRL_FLAG_NEXT_CTRL) {
    const bool number = query.type == V4L2_CTRL_TYPE_INTEGER || query.type == V4L2_CTRL_TYPE_BOOLEAN ||
                        query.type == V4L2_CTRL_TYPE_MENU || query.type == V4L2_CTRL_TYPE_INTEGER_MENU ||
                        query.type == V4L2_CTRL_TYPE_BUTTON;
    if (number && (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0) use(query);
  }
}

std::optional<Device> find_by(Calls& calls, const std::string& selector) {
  const std::size_t colon = selector.find(':');
  const std::string kind = selector.substr(0, colon), wanted = selector.substr(colon + 1);
  for (const std::string& path : calls.devices()) {
    Device device{path, calls.open(path)};
    v4l2_capability cap;
    // A camera may have more nodes (metadata) with the same serial number and bus.
    if (!device.fd || !captures(calls, device.fd.get(), cap)) continue;
    if ((kind == "serial" ? calls.serial(path) : text_of(cap.bus_info)) == wanted) return device;
  }
  return std::nullopt;
}

}  // namespace

std::string errno_text(int error) {
  return " failed: " + std::generic_category().message(error) + " (errno " + std::to_string(error) + ")";
}

std::optional<Device> find_device(Calls& calls, const std::string& selector, const std::string& camera) {
  if (selector.starts_with("serial:") || selector.starts_with("bus:")) return find_by(calls, selector);
  const std::string where = "camera '" + camera + "'";
  if (!selector.starts_with("/")) {
    throw InputError(where, in_quotes(selector) + " names no device", "give /dev/videoN, serial:... or bus:...");
  }
  Device device{selector, calls.open(selector)};
  if (!device.fd) {
    const int error = errno;
    if (error == ENOENT || error == ENODEV || error == ENXIO) return std::nullopt;
    throw RuntimeFailure(where + ": opening " + selector + errno_text(error),
                         error == EACCES ? "add this user to the group video" : "see whether another program has it");
  }
  v4l2_capability cap;
  if (!captures(calls, device.fd.get(), cap)) {
    throw InputError(where, selector + " does not capture images", "choose one of: " + list_devices(calls));
  }
  return device;
}

std::string list_devices(Calls& calls) {
  std::string out;
  for (const std::string& path : calls.devices()) {
    const UniqueFd fd = calls.open(path);
    v4l2_capability cap;
    if (!fd || !captures(calls, fd.get(), cap)) continue;
    const std::string serial = calls.serial(path);
    out += (out.empty() ? "" : ", ") + path + " (bus:" + text_of(cap.bus_info) +
           (serial.empty() ? "" : ", serial:" + serial) + ")";
  }
  return out.empty() ? "no camera is connected" : out;
}

std::optional<std::uint32_t> fourcc(PixelFormat format) {
  for (const auto& row : kFormats)
    if (row.format == format) return row.fourcc;
  return std::nullopt;
}

Format set_format(Calls& calls, const Device& device, const CameraSettings& settings, const std::string& camera) {
  const std::string where = "camera '" + camera + "', " + device.path;
  const int fd = device.fd.get();
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_pix_format& pix = format.fmt.pix;
  pix.width = static_cast<__u32>(settings.width);
  pix.height = static_cast<__u32>(settings.height);
  const std::uint32_t wanted = offered_fourcc(calls, fd, settings.format, where);
  pix.pixelformat = wanted;
  pix.field = V4L2_FIELD_NONE;
  if (calls.ioctl(fd, VIDIOC_S_FMT, &format) != 0) {
    throw RuntimeFailure(where + ": VIDIOC_S_FMT" + errno_text(errno), "see whether another program has the camera");
  }
  const auto size = [](long w, long h) { return std::to_string(w) + "x" + std::to_string(h); };
  const bool same_size =
      static_cast<int>(pix.width) == settings.width && static_cast<int>(pix.height) == settings.height;
  if (pix.pixelformat != wanted || !same_size) {
    throw InputError(where,
                     "it does not do " + size(settings.width, settings.height) + " " + to_string(settings.format),
                     "the nearest that it does is " + size(pix.width, pix.height));
  }
  return {.stride = settings.format == PixelFormat::mjpeg ? 0 : pix.bytesperline,
          .size = pix.sizeimage,
          .rate = set_rate(calls, fd, settings.rate)};
}

std::vector<CameraControl> list_controls(Calls& calls, const Device& device) {
  std::vector<CameraControl> out;
  for_each_control(calls, device.fd.get(), [&](const v4l2_queryctrl& query) {
    v4l2_control value{query.id, query.default_value};
    calls.ioctl(device.fd.get(), VIDIOC_G_CTRL, &value);  // write-only ones keep their default
    out.push_back({plain_name(text_of(query.name)), query.minimum, query.maximum, query.step, value.value});
  });
  return out;
}

bool set_control(Calls& calls, const Device& device, const std::string& control, std::int64_t value,
                 const std::string& camera) {
  const std::string where = "camera '" + camera + "', " + device.path;
  std::optional<v4l2_queryctrl> found;
  std::vector<std::string> names;
  for_each_control(calls, device.fd.get(), [&](const v4l2_queryctrl& query) {
    names.push_back(plain_name(text_of(query.name)));
    if (names.back() == control) found = query;
  });
  if (!found) {
    throw InputError(where, "it has no control " + in_quotes(control), did_you_mean(control, names, "leave it out"));
  }
  if (value < found->minimum || value > found->maximum) {
    throw InputError(where, control + " = " + std::to_string(value),
                     "give " + std::to_string(found->minimum) + " to " + std::to_string(found->maximum));
  }
  v4l2_control setting{found->id, static_cast<__s32>(value)};
  if (calls.ioctl(device.fd.get(), VIDIOC_S_CTRL, &setting) != 0) {
    throw RuntimeFailure(where + ": setting " + control + " to " + std::to_string(value) + errno_text(errno),
                         "switch off the automatic control that holds it");
  }
  return found->type != V4L2_CTRL_TYPE_BUTTON;
}

void set_exposure(Calls& calls, const Device& device, Duration wanted, const std::string& camera) {
  const std::string where = "camera '" + camera + "', " + device.path;
  const int fd = device.fd.get();
  v4l2_control manual{V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL};
  calls.ioctl(fd, VIDIOC_S_CTRL, &manual);  // cameras without automatic exposure have no such control
  const auto count = std::max<std::int64_t>(1, std::llround(to_seconds(wanted) / kExposureUnit));
  v4l2_control control{V4L2_CID_EXPOSURE_ABSOLUTE, static_cast<__s32>(std::min<std::int64_t>(count, INT32_MAX))};
  const bool set = calls.ioctl(fd, VIDIOC_S_CTRL, &control) == 0;
  const auto got = exposure(calls, fd);
  if (!got) throw InputError(where, "its exposure cannot be set", "leave the exposure out");
  if (!set || std::chrono::abs(*got - wanted) > wanted / 10 + seconds(kExposureUnit))
    throw InputError(where, "it does not do an exposure of " + std::to_string(to_seconds(wanted)) + " s",
                     "it stands at " + std::to_string(to_seconds(*got)) + " s; choose another");
}

std::optional<Duration> exposure(Calls& calls, int fd) noexcept {
  v4l2_control control{V4L2_CID_EXPOSURE_ABSOLUTE, 0};
  if (calls.ioctl(fd, VIDIOC_G_CTRL, &control) != 0 || control.value <= 0) return std::nullopt;
  return seconds(kExposureUnit) * control.value;
}

}  // namespace foresight::v4l2
