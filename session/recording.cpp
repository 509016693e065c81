#include "session/recording.hpp"

#include <fmt/core.h>

#include "common/error.hpp"
#include "session/stop_latency.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

unsigned long long number(std::uint64_t n) {
  return n;
}

std::string why_silent(const StereoStatus& status, Duration silent) {
  std::string text = fmt::format("no pair of images came for {:.3g} s", to_seconds(silent));
  if (*status.reason) text += std::string(": ") + status.reason;
  for (std::size_t i = 0; i < 2; ++i)
    if (status.cameras[i] != CameraStatus::ok)
      text += fmt::format(", {} camera: {}", i ? "right" : "left", to_string(status.cameras[i]));
  return text;
}

struct Stopping {  // also where something throws
  StereoCamera& cameras;
  LiveFrames& frames;
  ~Stopping() {
    cameras.stop();
    frames.stop();
  }
};

}  // namespace

RecordingResult record(StereoCamera& cameras, LiveFrames& frames, RunRecorder& recorder, const RecordingLimits& limits,
                       const Clock& clock, const std::function<bool()>& stop) {
  RecordingResult result;
  cameras.start();
  frames.start();
  {
    const Stopping stopping{cameras, frames};
    std::uint64_t pairs = 0;
    std::optional<RobotTime> first;
    RobotTime heard = clock.now();
    while (!stop() && !recorder.stopped() && !(limits.count && pairs >= *limits.count)) {
      const auto pair = cameras.take(kStopLatency);
      if (!pair) {
        if (clock.now() - heard <= limits.silent_after) continue;
        result.fault = why_silent(cameras.status(), clock.now() - heard);
        break;
      }
      heard = clock.now();
      if (!first) first = pair->left.time;
      if (limits.length && pair->left.time - *first >= *limits.length) break;
      frames.add(*pair);
      ++pairs;
    }
    result.cameras = cameras.status();
    if (pairs == 0 && !result.fault.empty())
      throw RuntimeFailure(result.fault + "; nothing was recorded", "check the cables, and `foresight doctor`");
  }
  result.unregistered = frames.dropped();
  result.counts = recorder.finish(camera_remarks(result.cameras) + registration_remarks(frames));
  if (const std::string fault = recorder.fault(); !fault.empty()) result.fault = fault;
  return result;
}

std::string camera_remarks(const StereoStatus& status) {
  const auto& p = status.pairing;
  return fmt::format("missed_pairs: {}\nunpaired: [{}, {}]\nwrong_times: [{}, {}]\ndamaged: [{}, {}]\n",
                     number(status.dropped), number(p.unpaired[0]), number(p.unpaired[1]), number(p.jumps[0]),
                     number(p.jumps[1]), number(status.corrupt[0]), number(status.corrupt[1]));
}

std::string registration_remarks(const LiveFrames& frames) {
  return "unregistered: " + std::to_string(frames.dropped()) + "\n";
}

std::string counts_text(const RecordingResult& result) {
  std::string text = fmt::format("{} pairs\n", number(result.counts.written));
  const auto line = [&text](std::uint64_t n, const char* what) {
    if (n) text += fmt::format("{} {}\n", number(n), what);
  };
  line(result.counts.without_pose, "pairs of these have no pose: they are in without_pose.txt, not in the run");
  line(result.counts.dropped, "pairs dropped: the disk was too slow");
  line(result.unregistered, "pairs dropped: their registration was too slow");
  line(result.cameras.dropped, "pairs missed: this machine was too slow");
  const char* const sides[] = {"left", "right"};
  for (std::size_t i = 0; i < 2; ++i) {
    line(result.cameras.pairing.unpaired[i], fmt::format("{} images without a partner", sides[i]).c_str());
    line(result.cameras.pairing.jumps[i], fmt::format("{} images with a wrong time", sides[i]).c_str());
    line(result.cameras.corrupt[i], fmt::format("{} images were damaged", sides[i]).c_str());
  }
  return text;
}

}  // namespace foresight
