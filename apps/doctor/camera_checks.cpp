// Cameras that V4L2 and libcamera know.
#include "apps/doctor/findings.hpp"
#include "common/clock.hpp"
#include "common/held_stderr.hpp"
#include "drivers/camera/libcamera_session.hpp"
#include "drivers/camera/v4l2_calls.hpp"
#include "drivers/camera/v4l2_camera.hpp"

namespace foresight::doctor {
namespace {

// What libcamera warns of (pipelines that are not configured, sensors that it does not know) is no finding.
Findings libcamera_cameras() {
  const HeldStderr warnings;
  try {
    Findings out;
    for (const std::string& camera : libcam::library().cameras())
      out.push_back({Verdict::good, "libcamera", camera, ""});
    if (out.empty()) out.push_back({Verdict::absent, "libcamera", "knows no camera", ""});
    return out;
  } catch (const std::exception& error) {
    return {{Verdict::absent, "libcamera", error.what(), warnings.text()}};
  }
}

}  // namespace

Findings check_cameras() {
  v4l2::Calls& calls = v4l2::system_calls();
  Findings out;
  MonotonicClock clock;
  for (const std::string& device : calls.devices()) {
    const std::string subject = "camera " + device;
    try {
      V4l2Camera::Options options;
      options.device = device;
      V4l2Camera camera(device, options, clock, calls);
      camera.start();
      CameraFrame frame;
      camera.wait_frame(std::chrono::seconds(2), frame);  // the first is often late or torn
      const RobotTime before = clock.now();
      int frames = 0;
      while (frames < 10 && camera.wait_frame(std::chrono::seconds(1), frame) == CameraStatus::ok) ++frames;
      const double seconds = to_seconds(clock.now() - before);
      if (frames == 10)
        out.push_back({Verdict::good, subject,
                       "delivers " + std::to_string(static_cast<int>(10 / seconds + 0.5)) + " images per second", ""});
      else
        out.push_back(
            {Verdict::bad, subject, "delivers no images", "unplug it and plug it in again; use another cable or port"});
    } catch (const std::exception& error) {
      out.push_back({Verdict::absent, subject, error.what(), ""});
    }
  }
  if (out.empty())
    out.push_back({Verdict::absent, "cameras", "none that V4L2 knows",
                   "plug one in; `foresight synth` and mock cameras work without"});
  const Findings more = libcamera_cameras();
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

}  // namespace foresight::doctor
