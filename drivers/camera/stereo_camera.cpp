#include "drivers/camera/stereo_camera.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kWaitTime = 100ms;  // so long a stop may take
constexpr int kPolled = 4;             // images that poll() takes of one camera, at most
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

void StereoCamera::start_polled() {
  stop();
  cameras_[0]->start();
  try {
    cameras_[1]->start();
  } catch (...) {
    cameras_[0]->stop();
    throw;
  }
  polled_ = true;
}

void StereoCamera::start() {
  start_polled();
  polled_ = false;
  for (Side side : {Side::left, Side::right}) {
    threads_[static_cast<std::size_t>(side)] =
        std::jthread([this, side](const std::stop_token& stop) { run(stop, side); });
  }
}

void StereoCamera::stop() noexcept {
  for (std::jthread& thread : threads_) thread.request_stop();
  for (std::size_t i = 0; i < 2; ++i) {
    if (!threads_[i].joinable() && !polled_) continue;
    if (threads_[i].joinable()) threads_[i].join();
    cameras_[i]->stop();
  }
  polled_ = false;
}

void StereoCamera::poll() noexcept {
  // One image is all that a period brings; more are rest of a pause.
  for (Side side : {Side::left, Side::right})
    for (int i = 0; i < kPolled && look(side, Duration{0}) == CameraStatus::ok; ++i) {
    }
}

void StereoCamera::run(const std::stop_token& stop, Side side) noexcept {
  while (!stop.stop_requested())
    if (look(side, kWaitTime) == CameraStatus::lost) std::this_thread::sleep_for(kRestTime);
}

CameraStatus StereoCamera::look(Side side, Duration timeout) noexcept {
  const auto index = static_cast<std::size_t>(side);
  CameraFrame frame;
  CameraStatus status = cameras_[index]->wait_frame(timeout, frame);
  ColourImage image;
  if (status == CameraStatus::ok && to_bgr(frame, image.bgr) != Conversion::ok) status = CameraStatus::corrupt;
  if (status == CameraStatus::corrupt) ++corrupt_[index];
  // Looking without waiting finds nothing most of the time, which says nothing of the camera.
  if (status != CameraStatus::timeout || timeout.count() > 0 || statuses_[index] == CameraStatus::lost)
    statuses_[index] = status;
  if (status != CameraStatus::ok) return status;
  image.sequence = frame.sequence;
  image.time = frame.time;
  image.uncertainty = frame.uncertainty;
  const std::lock_guard lock(mutex_);
  if (auto pair = pairing_.add(side, std::move(image), clock_.now())) newest_.put(std::move(*pair));
  return status;
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

std::string fault_text(const StereoStatus& status) {
  const auto lost = [&](Side side) { return status.cameras[static_cast<std::size_t>(side)] == CameraStatus::lost; };
  const bool left = lost(Side::left), right = lost(Side::right);
  if (!left && !right) return status.reason;
  const std::string who = left && right ? "both cameras are" : left ? "the left camera is" : "the right camera is";
  return who + " lost: unplugged, or nothing comes; opened again on return";
}

}  // namespace foresight
