#include "drivers/camera/libcamera_camera.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "drivers/camera/capture_time.hpp"

namespace foresight {

LibcameraCamera::LibcameraCamera(std::string name, const Options& options, Clock& clock, libcam::Library& library)
    : name_(std::move(name)), options_(options), settings_(options.settings), clock_(clock), library_(library) {
  const auto need = [&](bool fine, const char* field, double value, const char* cure) {
    if (!fine) throw InputError("camera '" + name_ + "'", std::string(field) + " = " + std::to_string(value), cure);
  };
  need(settings_.width > 0, "width", settings_.width, "give more than 0");
  need(settings_.height > 0, "height", settings_.height, "give more than 0");
  need(settings_.rate > 0 && settings_.rate <= 1000, "rate", settings_.rate, "give 0 to 1000 frames per second");
  const double hang = to_seconds(options.hangs_after);
  need(hang * settings_.rate > 2, "hangs_after", hang, "give more than two frame periods");
}

LibcameraCamera::~LibcameraCamera() {
  stop();
}

void LibcameraCamera::start() {
  stop();
  counters_ = {};
  open();
  started_ = true;
}

void LibcameraCamera::stop() noexcept {
  session_.reset();
  lent_.reset();
  started_ = lost_ = false;
}

void LibcameraCamera::open() {
  session_ = library_.open(options_.device, settings_, name_);
  settings_ = session_->settings();
  lent_.reset();
  last_sequence_.reset();
  last_frame_ = clock_.now();
}

bool LibcameraCamera::reopen() noexcept {
  session_.reset();  // first: a camera has one owner
  try {
    open();
  } catch (const std::exception&) {  // not there, or not ready
    return false;
  }
  return true;
}

CameraStatus LibcameraCamera::lose() noexcept {
  session_.reset();
  lent_.reset();
  ++counters_.losses;
  lost_ = true;
  hangs_ = 0;
  last_try_ = clock_.now();
  return CameraStatus::lost;
}

CameraStatus LibcameraCamera::try_reopen(Duration timeout) noexcept {
  const RobotTime next = last_try_ + options_.reopen_every;
  clock_.sleep_until(std::min(clock_.now() + timeout, std::max(next, clock_.now())));
  if (clock_.now() < next) return CameraStatus::lost;
  last_try_ = clock_.now();
  if (!reopen()) return CameraStatus::lost;
  lost_ = false;
  return CameraStatus::timeout;
}

CameraStatus LibcameraCamera::nothing_came() noexcept {
  if (session_->gone()) return lose();
  if (clock_.now() - last_frame_ < options_.hangs_after) return CameraStatus::timeout;
  if (++hangs_ > kHangsUntilLost || !reopen()) return lose();
  ++counters_.restarts;
  return CameraStatus::timeout;
}

bool LibcameraCamera::give_back() noexcept {
  return !lent_ || session_->give_back(*std::exchange(lent_, std::nullopt));
}

CameraStatus LibcameraCamera::wait_frame(Duration timeout, CameraFrame& out) noexcept {
  if (lost_) return try_reopen(timeout);
  if (!started_) return CameraStatus::lost;
  if (!give_back()) return lose();
  const RobotTime until = clock_.now() + timeout;
  libcam::Finished finished;
  std::size_t taken = 0;
  CameraStatus status = wait_newest(timeout, finished, taken);
  if (status == CameraStatus::ok && taken > 1 && taken + 1 >= session_->buffers()) {
    // libcamera had run out of buffers: even the newest may be as old as the caller's pause.
    ++counters_.dropped;
    if (!give_back()) return lose();
    status = wait_newest(std::max(until - clock_.now(), Duration{0}), finished, taken);
  }
  if (status != CameraStatus::ok) return status;
  ++counters_.frames;
  describe(finished, out);
  return status;
}

CameraStatus LibcameraCamera::wait_newest(Duration timeout, libcam::Finished& newest, std::size_t& taken) noexcept {
  auto finished = session_->wait(timeout);
  if (!finished) return nothing_came();
  CameraStatus status = take(*finished);
  newest = *finished;
  // Not for ever: a fast camera fills what is given back.
  for (taken = 1; taken < session_->buffers(); ++taken) {
    finished = session_->wait(Duration{0});
    if (!finished) break;
    if (status == CameraStatus::ok) ++counters_.dropped;
    if (!give_back()) return lose();
    status = take(*finished);
    newest = *finished;
  }
  return status;
}

std::size_t LibcameraCamera::bytes_needed() const noexcept {
  if (settings_.format == PixelFormat::mjpeg) return 4;
  const auto rows = static_cast<std::size_t>(settings_.height);
  return session_->stride() * (settings_.format == PixelFormat::nv12 ? rows * 3 / 2 : rows);
}

CameraStatus LibcameraCamera::take(const libcam::Finished& finished) noexcept {
  last_frame_ = clock_.now();
  lent_ = finished.buffer;
  if (last_sequence_) {
    const std::uint32_t step = finished.sequence - *last_sequence_;
    if (step > 1 && step < 0x80000000u) counters_.gaps += step - 1;
  }
  last_sequence_ = finished.sequence;
  if (!finished.complete || finished.bytes.size() < bytes_needed()) {
    ++counters_.corrupt;
    return CameraStatus::corrupt;
  }
  hangs_ = 0;
  return CameraStatus::ok;
}

void LibcameraCamera::describe(const libcam::Finished& finished, CameraFrame& out) const noexcept {
  out.format = settings_.format;
  out.width = settings_.width;
  out.height = settings_.height;
  out.stride = session_->stride();
  out.bytes = finished.bytes;
  out.pixels.release();
  out.dmabuf = -1;
  out.sequence = finished.sequence;
  const auto fixed = settings_.exposure.count() > 0 ? std::optional(settings_.exposure) : std::nullopt;
  const ToMiddle middle = to_middle_of_exposure(finished.exposure ? finished.exposure : fixed, settings_);
  out.time = finished.stamp + middle.span;
  out.uncertainty = middle.uncertainty;
}

std::vector<CameraControl> LibcameraCamera::controls() {
  if (session_) return session_->controls();
  return {};
}

void LibcameraCamera::set_control(const std::string& control, std::int64_t value) {
  if (!session_)
    throw RuntimeFailure("camera '" + name_ + "': setting " + control + " while the camera is not open", "start it");
  session_->set_control(control, value);
  settings_.controls[control] = value;  // set again after a return of the device
}

}  // namespace foresight
