// A V4L2 camera without a kernel, with faults to order.
#pragma once

#include <deque>
#include <map>
#include <vector>

#include "common/clock.hpp"
#include "drivers/camera/v4l2_device.hpp"

namespace foresight {

/// One YUYV camera of 64x48 at 30 fps at /dev/video2 (/dev/video0 is a metadata node), in stepped time. Stamps the
/// start of the exposure and fills each frame with its sequence number.
class FakeV4l2 final : public v4l2::Calls {
 public:
  explicit FakeV4l2(SteppedClock& clock);

  // Faults.
  bool present = true;          ///< unplugged: every call fails with ENODEV
  bool hangs = false;           ///< no frames, until the stream is restarted
  bool hangs_for_good = false;  ///< nor then
  std::uint32_t extra_flags = 0;
  std::uint32_t clear_flags = 0;
  std::uint32_t bytes_used = 0;           ///< instead of all; 0: all
  std::uint32_t skip = 0;                 ///< sequence numbers lost before the next frame
  Duration jump{0};                       ///< added to the time stamps
  int refuse_after = 0;                   ///< so many buffers queued, the last one is refused; 0: never
  std::map<unsigned long, int> failures;  ///< ioctl request to errno

  // What it saw and has.
  int opened = 0, streams_started = 0, mapped = 0;
  std::uint32_t exposure = 100;  ///< in 0.1 ms
  std::map<std::uint32_t, std::int32_t> controls;
  std::size_t queued() const { return queue_.size(); }

  std::vector<std::string> devices() override;
  std::string serial(const std::string& device) override;
  UniqueFd open(const std::string& device) override;
  int ioctl(int fd, unsigned long request, void* argument) override;
  void* map(std::size_t bytes, int fd, std::int64_t offset) override;
  void unmap(void* address, std::size_t bytes) override;
  int wait(int fd, Duration timeout, bool& broken) override;

 private:
  struct Filled {
    std::uint32_t index, sequence;
    RobotTime stamp;
  };
  void tick(RobotTime now);
  int answer(unsigned long request, void* argument);
  int dequeue(v4l2_buffer& buffer);
  int query_control(v4l2_queryctrl& query);
  int set_stream(bool on);

  SteppedClock& clock_;
  std::vector<std::vector<std::uint8_t>> memory_;
  std::deque<std::uint32_t> queue_;
  std::deque<Filled> filled_;
  bool streaming_ = false;
  std::uint32_t sequence_ = 0;
};

}  // namespace foresight
