#include "drivers/camera/stereo_camera.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kWaitTime = 100ms;  // so long a stop may take
constexpr Duration kRestTime = 10ms;   // after a status that came at once, lest a lost camera takes a whole core

}  // namespace

const char* to_string(CameraStatus status) {
  switch (status) {
    case CameraStatus::ok: return "ok";
    case CameraStatus::timeout: return "timeout";
    case CameraStatus::lost: return "lost";
    case CameraStatus::corrupt: return "corrupt";
  }
  return "?";
}

StereoCamera::StereoCamera(std::unique_ptr<Camera> left, std::unique_ptr<Camera> right, const Clock& clock,
                           const PairingOptions& options)
    : cameras_{std::move(left), std::move(right)}, clock_(clock), pairing_(options) {}

StereoCamera::~StereoCamera() {
  stop();
}

void StereoCamera::start() {
  cameras_[0]->start();
  try {
    cameras_[1]->start();
  } catch (...) {
    cameras_[0]->stop();
    throw;
  }
  for (Side side : {Side::left, Side::right}) {
    threads_[static_cast<std::size_t>(side)] =
        std::jthread([this, side](const std::stop_token& stop) { run(stop, side); });
  }
}

void StereoCamera::stop() noexcept {
  for (std::jthread& thread : threads_) thread.request_stop();
  for (std::size_t i = 0; i < 2; ++i) {
    if (!threads_[i].joinable()) continue;
    threads_[i].join();
    cameras_[i]->stop();
  }
}

void StereoCamera::run(const std::stop_token& stop, Side side) noexcept {
  const auto index = static_cast<std::size_t>(side);
  Camera& camera = *cameras_[index];
  while (!stop.stop_requested()) {
    CameraFrame frame;
    CameraStatus status = camera.wait_frame(kWaitTime, frame);
    ColourImage image;
    if (status == CameraStatus::ok && to_bgr(frame, image.bgr) != Conversion::ok) status = CameraStatus::corrupt;
    if (status == CameraStatus::corrupt) ++corrupt_[index];
    statuses_[index] = status;
    if (status == CameraStatus::lost) std::this_thread::sleep_for(kRestTime);
    if (status != CameraStatus::ok) continue;
    image.sequence = frame.sequence;
    image.time = frame.time;
    image.uncertainty = frame.uncertainty;
    const std::lock_guard lock(mutex_);
    if (auto pair = pairing_.add(side, std::move(image), clock_.now())) newest_.put(std::move(*pair));
  }
}

StereoStatus StereoCamera::status() const noexcept {
  StereoStatus out;
  for (std::size_t i = 0; i < 2; ++i) {
    out.cameras[i] = statuses_[i];
    out.corrupt[i] = corrupt_[i];
  }
  out.dropped = newest_.dropped();
  const std::lock_guard lock(mutex_);
  out.pairing = pairing_.counters();
  out.reason = pairing_.reason(clock_.now());
  return out;
}

}  // namespace foresight
