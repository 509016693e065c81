#include "drivers/camera/v4l2_camera.hpp"

#include <fcntl.h>
#include <algorithm>

#include <cerrno>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/camera/capture_time.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr int kExposureFrames = 30;  // reading a control of a USB camera takes a millisecond

v4l2_buffer capture_buffer(std::uint32_t index = 0) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

V4l2Camera::V4l2Camera(std::string name, const Options& options, Clock& clock, v4l2::Calls& calls)
    : name_(std::move(name)), options_(options), settings_(options.settings), clock_(clock), calls_(calls) {
  const auto need = [&](bool fine, const char* field, double value, const char* cure) {
    if (!fine) throw InputError("camera '" + name_ + "'", std::string(field) + " = " + std::to_string(value), cure);
  };
  const CameraSettings& s = options.settings;
  need(s.width > 0, "width", s.width, "give more than 0");
  need(s.height > 0, "height", s.height, "give more than 0");
  need(s.rate > 0 && s.rate <= 1000, "rate", s.rate, "give 0 to 1000 frames per second");
  need(options.buffers >= 2 && options.buffers <= 32, "buffers", options.buffers, "give 2 to 32");
  const double hang = to_seconds(options.hangs_after);
  need(hang * s.rate > 2, "hangs_after", hang, "give more than two frame periods");
}

V4l2Camera::~V4l2Camera() {
  stop();
}

void V4l2Camera::start() {
  stop();
  counters_ = {};
  open();
  started_ = true;
}

void V4l2Camera::stop() noexcept {
  close();
  started_ = lost_ = false;
}

void V4l2Camera::open() {
  auto found = v4l2::find_device(calls_, options_.device, name_);
  if (!found) {
    throw InputError("camera '" + name_ + "'", "there is no device " + in_quotes(options_.device),
                     "connect it, or choose one of: " + v4l2::list_devices(calls_));
  }
  device_ = std::move(*found);
  try {
    format_ = v4l2::set_format(calls_, device_, settings_, name_);
    settings_.rate = format_.rate;
    for (const auto& [control, value] : settings_.controls) v4l2::set_control(calls_, device_, control, value, name_);
    if (settings_.exposure.count() > 0) v4l2::set_exposure(calls_, device_, settings_.exposure, name_);
    map_buffers();
    if (!stream_on()) {
      throw RuntimeFailure("camera '" + name_ + "', " + device_.path + ": VIDIOC_STREAMON" + v4l2::errno_text(errno),
                           "for USB cameras, check that the bus has room for both: use mjpeg, or two controllers");
    }
  } catch (...) {
    close();
    throw;
  }
}

void V4l2Camera::map_buffers() {
  const auto fail = [&](const char* what) {
    throw RuntimeFailure("camera '" + name_ + "', " + device_.path + ": " + what + v4l2::errno_text(errno),
                         "see whether another program has the camera");
  };
  const int fd = device_.fd.get();
  v4l2_requestbuffers request{};
  request.count = static_cast<__u32>(options_.buffers);
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (calls_.ioctl(fd, VIDIOC_REQBUFS, &request) != 0 || request.count < 2) fail("VIDIOC_REQBUFS");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer info = capture_buffer(i);
    if (calls_.ioctl(fd, VIDIOC_QUERYBUF, &info) != 0) fail("VIDIOC_QUERYBUF");
    Buffer buffer;
    buffer.size = info.length;
    buffer.address = calls_.map(info.length, fd, info.m.offset);
    if (buffer.address == nullptr) fail("mmap");
    v4l2_exportbuffer exported{};
    exported.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    exported.index = i;
    exported.flags = O_CLOEXEC;
    // Not every driver can; then there is the mapping.
    if (calls_.ioctl(fd, VIDIOC_EXPBUF, &exported) == 0) buffer.dmabuf = UniqueFd(exported.fd);
    buffers_.push_back(std::move(buffer));
  }
}

void V4l2Camera::close() noexcept {
  if (device_.fd) {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    calls_.ioctl(device_.fd.get(), VIDIOC_STREAMOFF, &type);
  }
  for (const Buffer& buffer : buffers_) calls_.unmap(buffer.address, buffer.size);
  buffers_.clear();
  device_ = {};
  lent_.reset();
}

bool V4l2Camera::queue(std::uint32_t index) noexcept {
  v4l2_buffer buffer = capture_buffer(index);
  return calls_.ioctl(device_.fd.get(), VIDIOC_QBUF, &buffer) == 0;
}

bool V4l2Camera::stream_on() noexcept {
  for (std::uint32_t i = 0; i < buffers_.size(); ++i)
    if (!queue(i)) return false;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (calls_.ioctl(device_.fd.get(), VIDIOC_STREAMON, &type) != 0) return false;
  last_frame_ = clock_.now();
  last_sequence_.reset();
  lent_.reset();
  exposure_age_ = 0;
  return true;
}

bool V4l2Camera::restart() noexcept {
  ++counters_.restarts;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  return calls_.ioctl(device_.fd.get(), VIDIOC_STREAMOFF, &type) == 0 && stream_on();
}

bool V4l2Camera::give_back() noexcept {
  if (!lent_) return true;
  const std::uint32_t index = *lent_;
  lent_.reset();
  return queue(index) || (errno != ENODEV && restart());
}

CameraStatus V4l2Camera::lose() noexcept {
  close();
  ++counters_.losses;
  lost_ = true;
  hangs_ = 0;
  last_try_ = clock_.now();
  return CameraStatus::lost;
}

CameraStatus V4l2Camera::try_reopen(Duration timeout) noexcept {
  const RobotTime until = clock_.now() + timeout, next = last_try_ + options_.reopen_every;
  clock_.sleep_until(std::min(until, next));
  if (clock_.now() < next) return CameraStatus::lost;
  last_try_ = clock_.now();
  try {
    open();
  } catch (const std::exception&) {  // not back yet, or not ready yet
    return CameraStatus::lost;
  }
  lost_ = false;
  return CameraStatus::timeout;
}

CameraStatus V4l2Camera::nothing_came(RobotTime now) noexcept {
  if (now - last_frame_ < options_.hangs_after) return CameraStatus::timeout;
  if (++hangs_ > kHangsUntilLost || !restart()) return lose();
  return CameraStatus::timeout;
}

CameraStatus V4l2Camera::wait_frame(Duration timeout, CameraFrame& out) noexcept {
  if (lost_) return try_reopen(timeout);
  if (!started_) return CameraStatus::lost;
  if (!give_back()) return lose();
  const RobotTime until = clock_.now() + timeout;
  v4l2_buffer buffer{};
  std::size_t taken = 0;
  CameraStatus status = wait_newest(timeout, buffer, taken);
  if (status == CameraStatus::ok && taken > 1 && taken + 1 >= buffers_.size()) {
    // The driver had run out of buffers: even the newest may be as old as the caller's pause.
    ++counters_.dropped;
    if (!give_back()) return lose();
    status = wait_newest(std::max(until - clock_.now(), Duration{0}), buffer, taken);
  }
  if (status != CameraStatus::ok) return status;
  ++counters_.frames;
  describe(buffer, out);
  return status;
}

CameraStatus V4l2Camera::wait_newest(Duration timeout, v4l2_buffer& buffer, std::size_t& taken) noexcept {
  bool broken = false;
  const int ready = calls_.wait(device_.fd.get(), timeout, broken);
  if (ready == 0) return nothing_came(clock_.now());
  if (ready < 0) return lose();
  CameraStatus status = dequeue(buffer);  // of a broken device, too: that says how it is broken
  // Not for ever: a fast camera fills what is given back.
  for (taken = 1; taken < buffers_.size() && lent_; ++taken) {
    if (calls_.wait(device_.fd.get(), Duration{0}, broken) <= 0 || broken) break;
    if (status == CameraStatus::ok) ++counters_.dropped;
    if (!give_back()) return lose();
    status = dequeue(buffer);
  }
  return status;
}

CameraStatus V4l2Camera::dequeue(v4l2_buffer& buffer) noexcept {
  buffer = capture_buffer();
  if (calls_.ioctl(device_.fd.get(), VIDIOC_DQBUF, &buffer) != 0) {
    if (errno == EAGAIN) return nothing_came(clock_.now());
    if (errno == ENODEV || errno == ENXIO || errno == EBADF) return lose();
    ++counters_.corrupt;
    return ++hangs_ > kHangsUntilLost || !restart() ? lose() : CameraStatus::corrupt;
  }
  if (buffer.index >= buffers_.size()) return lose();
  last_frame_ = clock_.now();
  lent_ = buffer.index;
  if (last_sequence_) {
    const std::uint32_t step = buffer.sequence - *last_sequence_;
    if (step > 1 && step < 0x80000000u) counters_.gaps += step - 1;
  }
  last_sequence_ = buffer.sequence;
  const std::size_t size = buffers_[buffer.index].size;
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || buffer.bytesused < bytes_needed() || buffer.bytesused > size) {
    ++counters_.corrupt;
    return CameraStatus::corrupt;
  }
  hangs_ = 0;
  return CameraStatus::ok;
}

std::size_t V4l2Camera::bytes_needed() const noexcept {
  if (settings_.format == PixelFormat::mjpeg) return 4;
  const auto rows = static_cast<std::size_t>(settings_.height);
  return format_.stride * (settings_.format == PixelFormat::nv12 ? rows * 3 / 2 : rows);
}

void V4l2Camera::describe(const v4l2_buffer& buffer, CameraFrame& out) noexcept {
  const Buffer& memory = buffers_[buffer.index];
  out.format = settings_.format;
  out.width = settings_.width;
  out.height = settings_.height;
  out.stride = format_.stride;
  out.bytes = {static_cast<const std::uint8_t*>(memory.address), buffer.bytesused};
  out.pixels.release();
  out.dmabuf = memory.dmabuf.get();
  out.sequence = buffer.sequence;
  stamp(buffer, out);
}

void V4l2Camera::stamp(const v4l2_buffer& buffer, CameraFrame& out) noexcept {
  // Automatic exposure changes it all the time.
  if (exposure_age_-- <= 0) {
    exposure_ = v4l2::exposure(calls_, device_.fd.get());
    exposure_age_ = kExposureFrames;
  }
  const ToMiddle middle = to_middle_of_exposure(exposure_, settings_);
  out.uncertainty = middle.uncertainty;
  if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    out.time = clock_.now() - middle.span;  // another clock: when we saw it is the best that is left
    out.uncertainty += seconds(1 / settings_.rate);
    return;
  }
  const RobotTime stamped{buffer.timestamp.tv_sec * std::int64_t{1'000'000'000} + buffer.timestamp.tv_usec * 1000};
  const bool at_start = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  out.time = at_start ? stamped + middle.span : stamped - middle.span;
}

std::vector<CameraControl> V4l2Camera::controls() {
  if (device_.fd) return v4l2::list_controls(calls_, device_);
  return {};
}

void V4l2Camera::set_control(const std::string& control, std::int64_t value) {
  if (!device_.fd) {
    throw RuntimeFailure("camera '" + name_ + "': setting " + control + " while the camera is not open", "start it");
  }
  const bool stays = v4l2::set_control(calls_, device_, control, value, name_);
  if (stays) settings_.controls[control] = value;  // set again after a return of the device
  exposure_age_ = 0;
}

}  // namespace foresight
