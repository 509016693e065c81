#include "tests/camera/fake_v4l2.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace foresight {
namespace {

constexpr std::size_t kFrameBytes = 64 * 48 * 2;
constexpr Duration kPeriod{33'333'333};

constexpr struct {
  std::uint32_t id;
  const char* name;
  std::int32_t minimum, maximum;
} kControls[] = {{V4L2_CID_BRIGHTNESS, "Brightness", 0, 255},
                 {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 1, 5000}};

template <std::size_t N>
void copy_text(__u8 (&to)[N], const char* from) {
  std::strncpy(reinterpret_cast<char*>(to), from, N - 1);
}

}  // namespace

FakeV4l2::FakeV4l2(SteppedClock& clock) : clock_(clock) {
  clock.every(kPeriod, [this](RobotTime now) { tick(now); });
}

void FakeV4l2::tick(RobotTime now) {
  if (!streaming_ || !present || hangs || hangs_for_good) return;
  sequence_ += 1 + skip;
  skip = 0;
  if (queue_.empty()) return;  // overrun: the frame is lost
  std::memset(memory_[queue_.front()].data(), static_cast<int>(sequence_ & 0xff), kFrameBytes);
  // The frame of which the exposure began one period ago.
  filled_.push_back({queue_.front(), sequence_, now - kPeriod + jump});
  queue_.pop_front();
}

std::vector<std::string> FakeV4l2::devices() {
  if (!present) return {};
  return {"/dev/video0", "/dev/video2"};
}

std::string FakeV4l2::serial(const std::string&) {
  return "C0FFEE";
}

UniqueFd FakeV4l2::open(const std::string& device) {
  if (!present || (device != "/dev/video0" && device != "/dev/video2")) {
    errno = ENOENT;
    return {};
  }
  ++opened;
  return UniqueFd(::open(device == "/dev/video0" ? "/dev/zero" : "/dev/null", O_RDWR | O_CLOEXEC));
}

int FakeV4l2::ioctl(int fd, unsigned long request, void* argument) {
  const auto failure = failures.find(request);
  const int error = !present ? ENODEV : failure != failures.end() ? failure->second : 0;
  if (error != 0) {
    errno = error;
    return -1;
  }
  if (request == VIDIOC_QUERYCAP) {
    char byte = 1;
    const bool metadata = ::read(fd, &byte, 1) == 1;  // /dev/zero gives, /dev/null does not
    auto& cap = *static_cast<v4l2_capability*>(argument);
    copy_text(cap.bus_info, "usb-fake-1");
    cap.capabilities = V4L2_CAP_DEVICE_CAPS;
    cap.device_caps = V4L2_CAP_STREAMING | (metadata ? V4L2_CAP_META_CAPTURE : V4L2_CAP_VIDEO_CAPTURE);
    return 0;
  }
  const int result = answer(request, argument);
  if (result == 0) return 0;
  errno = result;
  return -1;
}

int FakeV4l2::answer(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_ENUM_FMT: {
      auto& format = *static_cast<v4l2_fmtdesc*>(argument);
      if (format.index > 1) return EINVAL;
      format.pixelformat = format.index == 0 ? V4L2_PIX_FMT_YUYV : V4L2_PIX_FMT_MJPEG;
      return 0;
    }
    case VIDIOC_S_FMT: {
      auto& pix = static_cast<v4l2_format*>(argument)->fmt.pix;
      pix.width = 64;
      pix.height = 48;
      pix.bytesperline = pix.pixelformat == V4L2_PIX_FMT_YUYV ? 128 : 0;
      pix.sizeimage = kFrameBytes;
      return 0;
    }
    case VIDIOC_S_PARM: static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {1, 30}; return 0;
    case VIDIOC_REQBUFS:
      memory_.assign(static_cast<v4l2_requestbuffers*>(argument)->count, std::vector<std::uint8_t>(kFrameBytes));
      return 0;
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      buffer.length = kFrameBytes;
      buffer.m.offset = buffer.index;
      return 0;
    }
    case VIDIOC_EXPBUF:
      static_cast<v4l2_exportbuffer*>(argument)->fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
      return 0;
    case VIDIOC_QBUF:
      if (refuse_after > 0 && --refuse_after == 0) return EINVAL;
      queue_.push_back(static_cast<v4l2_buffer*>(argument)->index);
      return 0;
    case VIDIOC_DQBUF: return dequeue(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON: return set_stream(true);
    case VIDIOC_STREAMOFF: return set_stream(false);
    case VIDIOC_QUERYCTRL: return query_control(*static_cast<v4l2_queryctrl*>(argument));
    case VIDIOC_G_CTRL: {
      auto& control = *static_cast<v4l2_control*>(argument);
      if (control.id == V4L2_CID_EXPOSURE_ABSOLUTE && exposure == 0) return EINVAL;
      control.value = control.id == V4L2_CID_EXPOSURE_ABSOLUTE ? static_cast<__s32>(exposure) : controls[control.id];
      return 0;
    }
    case VIDIOC_S_CTRL: {
      const auto& control = *static_cast<v4l2_control*>(argument);
      controls[control.id] = control.value;
      if (control.id == V4L2_CID_EXPOSURE_ABSOLUTE) exposure = static_cast<std::uint32_t>(control.value);
      return 0;
    }
    default: return ENOTTY;
  }
}

int FakeV4l2::set_stream(bool on) {
  streaming_ = on;
  if (on) {
    ++streams_started;
    hangs = false;
    sequence_ = 0;
  } else {
    queue_.clear();
  }
  filled_.clear();
  return 0;
}

int FakeV4l2::dequeue(v4l2_buffer& buffer) {
  if (filled_.empty()) return EAGAIN;
  const Filled frame = filled_.front();
  filled_.pop_front();
  buffer.index = frame.index;
  buffer.sequence = frame.sequence;
  buffer.bytesused = bytes_used != 0 ? bytes_used : kFrameBytes;
  buffer.flags = ((V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE) & ~clear_flags) | extra_flags;
  buffer.timestamp = {frame.stamp.ns / 1'000'000'000, frame.stamp.ns / 1000 % 1'000'000};
  return 0;
}

int FakeV4l2::query_control(v4l2_queryctrl& query) {
  const std::uint32_t after = query.id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
  for (const auto& control : kControls) {
    if (control.id <= after) continue;
    query = {};
    query.id = control.id;
    query.type = V4L2_CTRL_TYPE_INTEGER;
    copy_text(query.name, control.name);
    query.minimum = control.minimum;
    query.maximum = control.maximum;
    query.step = 1;
    return 0;
  }
  return EINVAL;
}

void* FakeV4l2::map(std::size_t, int, std::int64_t offset) {
  ++mapped;
  return memory_[static_cast<std::size_t>(offset)].data();
}

void FakeV4l2::unmap(void*, std::size_t) {
  --mapped;
}

int FakeV4l2::wait(int, Duration timeout, bool& broken) {
  const RobotTime until = clock_.now() + timeout;
  while (filled_.empty() && present && clock_.now() < until) clock_.step_towards(until);
  broken = !present;
  return broken || !filled_.empty() ? 1 : 0;
}

}  // namespace foresight
