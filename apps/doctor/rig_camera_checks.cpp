// The cameras of a rig: each alone, then both as a pair.
#include <fmt/core.h>

#include <cmath>

#include "apps/doctor/findings.hpp"
#include "common/clock.hpp"
#include "rig/open_stereo.hpp"

namespace foresight::doctor {
namespace {

using namespace std::chrono_literals;

constexpr Duration kListen = 2s;
constexpr double kUsb2 = 35e6;        // bytes/s that a USB 2 controller carries in practice
constexpr double kOftenEnough = 0.9;  // of the rate asked for

const char* side_name(Side side) {
  return side == Side::left ? "left" : "right";
}

std::string description(const CameraSettings& s) {
  return fmt::format("{} x {} {}", s.width, s.height, to_string(s.format));
}

/// What is left of an uncompressed stream on the way to us; 0 for mjpeg, which takes what it needs.
double bytes_per_second(const CameraSettings& s) {
  const double pixels = s.rate * s.width * s.height;
  switch (s.format) {
    case PixelFormat::mjpeg: return 0;
    case PixelFormat::nv12: return 1.5 * pixels;
    case PixelFormat::bgr: return 3 * pixels;
    case PixelFormat::grey:
    case PixelFormat::bayer_rggb8:
    case PixelFormat::bayer_bggr8:
    case PixelFormat::bayer_gbrg8:
    case PixelFormat::bayer_grbg8: return pixels;
    default: return 2 * pixels;
  }
}

/// What a camera delivered within kListen.
struct Delivered {
  std::uint64_t frames = 0, corrupt = 0, backwards = 0;
  double rate = 0;
  Duration youngest = Duration::max(), oldest = Duration::min();  ///< ages of the capture times on arrival
};

Delivered look(Camera& camera, const Clock& clock) {
  Delivered out;
  CameraFrame frame;
  camera.wait_frame(2s, frame);  // the first is often late or torn
  RobotTime last{INT64_MIN};
  const RobotTime start = clock.now();
  for (RobotTime now = start; now - start < kListen; now = clock.now()) {
    const CameraStatus status = camera.wait_frame(kListen - (now - start), frame);
    if (status == CameraStatus::corrupt) ++out.corrupt;
    if (status == CameraStatus::lost) break;
    if (status != CameraStatus::ok) continue;
    const Duration age = clock.now() - frame.time;
    out.youngest = std::min(out.youngest, age);
    out.oldest = std::max(out.oldest, age);
    if (frame.time <= last) ++out.backwards;
    last = frame.time;
    ++out.frames;
  }
  out.rate = static_cast<double>(out.frames) / to_seconds(clock.now() - start);
  return out;
}

void judge(const Delivered& seen, const CameraSettings& settings, const PairingOptions& pairing,
           const std::string& subject, Findings& out) {
  if (seen.frames == 0) {
    out.push_back(
        {Verdict::bad, subject, "delivers no images", "unplug it and plug it in again; another cable or port"});
    return;
  }
  const bool often = seen.rate >= kOftenEnough * settings.rate;
  out.push_back({often ? Verdict::good : Verdict::poor, subject,
                 description(settings) + fmt::format(", {:.1f} images per second", seen.rate),
                 often ? "" : "give more light or a shorter exposure_s, use mjpeg, or ask for a lower rate_hz"});
  if (seen.corrupt > 0)
    out.push_back({Verdict::poor, subject,
                   fmt::format("{} damaged images", static_cast<unsigned long long>(seen.corrupt)),
                   "use another cable or port, or mjpeg"});
  const bool true_times = seen.backwards == 0 && seen.youngest > -100ms && seen.oldest < pairing.largest_age;
  out.push_back({true_times ? Verdict::good : Verdict::bad, subject,
                 fmt::format("its images are {:.0f} to {:.0f} ms old when they come{}", 1e3 * to_seconds(seen.youngest),
                             1e3 * to_seconds(seen.oldest), seen.backwards ? ", and their times go back" : ""),
                 true_times ? ""
                            : "its driver's clock is wrong: use another driver, or for uvcvideo "
                              "sudo modprobe -r uvcvideo; sudo modprobe uvcvideo hwtimestamps=0"});
}

void check_pairs(const StereoConfig& config, Findings& out) {
  try {
    MonotonicClock clock;
    const OpenStereo opened = open_stereo(config, {}, clock);
    opened.cameras->start();
    opened.cameras->take(2s);
    const std::uint64_t before = opened.cameras->status().pairing.pairs;
    clock.sleep_until(clock.now() + kListen);
    const StereoStatus status = opened.cameras->status();
    const double rate = static_cast<double>(status.pairing.pairs - before) / to_seconds(kListen);
    const std::string fault = fault_text(status);
    const bool often = rate >= kOftenEnough * config.camera(Side::left).settings.rate;
    const std::string what = fmt::format("{:.1f} pairs per second", rate) + (fault.empty() ? "" : "; " + fault);
    const char* const cure = rate == 0 ? "trigger both together, or raise pairing_tolerance_s"
                                       : "use mjpeg, or put each camera on a USB controller of its own (lsusb -t)";
    out.push_back({rate == 0 ? Verdict::bad
                   : often   ? Verdict::good
                             : Verdict::poor,
                   "camera pair", what, often ? "" : cure});
  } catch (const std::exception& error) {
    out.push_back({Verdict::bad, "camera pair", error.what(),
                   "put each camera on a USB controller of its own (lsusb -t), or use mjpeg"});
  }
}

}  // namespace

Findings check_camera(const StereoConfig& config, Side side, Clock& clock) {
  const std::string subject = std::string("camera ") + side_name(side);
  try {
    const auto camera = make_camera(side_name(side), config.camera(side), clock);
    camera->start();
    Findings out;
    judge(look(*camera, clock), camera->settings(), config.pairing, subject, out);
    return out;
  } catch (const std::exception& error) {
    return {{Verdict::bad, subject, error.what(), ""}};
  }
}

Findings check_rig_cameras(const StereoConfig& config) {
  if (config.mock()) return {{Verdict::good, "cameras", "mock", ""}};
  Findings out;
  double bytes = 0;
  bool both = true;
  for (const Side side : {Side::left, Side::right}) {
    MonotonicClock clock;
    const Findings found = check_camera(config, side, clock);
    both = both && found.front().verdict != Verdict::bad;
    out.insert(out.end(), found.begin(), found.end());
    const CameraDriver driver = config.camera(side).driver;
    if (driver != CameraDriver::images) bytes += bytes_per_second(config.camera(side).settings);
  }
  if (bytes > 0)
    out.push_back({bytes > kUsb2 ? Verdict::poor : Verdict::good, "camera bandwidth",
                   fmt::format("{:.0f} MB/s uncompressed", bytes / 1e6),
                   bytes > kUsb2 ? "more than one USB 2 controller carries: use mjpeg, USB 3 or two controllers" : ""});
  if (both) check_pairs(config, out);
  return out;
}

}  // namespace foresight::doctor
