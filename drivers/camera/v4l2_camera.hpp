// Cameras of the Linux kernel (V4L2): USB (UVC), and whatever else has a /dev/videoN.
#pragma once

#include "common/clock.hpp"
#include "drivers/camera/camera.hpp"
#include "drivers/camera/v4l2_calls.hpp"
#include "drivers/camera/v4l2_device.hpp"

namespace foresight {

/// Streams from memory that it shares with the driver; frames borrow it, for the GPU too (CameraFrame::dmabuf, where
/// the driver exports). Single-planar formats.
///
/// Capture time: the kernel stamps, on CLOCK_MONOTONIC, the start of the exposure (SOE) or the end of the frame (EOF)
/// of a sensor that reads row after row:
///
///   first row  |<-exposure->|                      middle of the middle row
///    ...           |<-exposure->|                    = SOE + (exposure + readout) / 2
///   last row           |<-exposure->|                = EOF - (exposure + readout) / 2
///             SOE      |<-readout-->| EOF
///
/// A period is the most that unknown parts can take; what is not known widens CameraFrame::uncertainty.
///
/// After a pause of the caller the newest frame comes, not the oldest that waits: those in between are `dropped`, and
/// all of them where the driver ran out of buffers, as then even the newest may be old.
///
/// Damaged or short frames are `corrupt`, counted. A stream that hangs is restarted; a device that goes, or hangs
/// after restarts, is `lost` and opened again, with all its settings, when it returns under its selector.
class V4l2Camera final : public Camera {
 public:
  struct Options {
    std::string device = "/dev/video0";  ///< path, "serial:..." or "bus:..."; the latter two survive a new number
    CameraSettings settings;
    int buffers = 4;                      ///< 2 .. 32
    Duration hangs_after{1'000'000'000};  ///< without a frame; more than 2 frame periods
    Duration reopen_every{500'000'000};   ///< while lost
  };
  /// Opens nothing yet. `clock` (of CLOCK_MONOTONIC) and `calls` must outlive this. Throws InputError (bad option).
  V4l2Camera(std::string name, const Options& options, Clock& clock, v4l2::Calls& calls = v4l2::system_calls());
  ~V4l2Camera() override;

  const std::string& name() const noexcept override { return name_; }
  void start() override;
  void stop() noexcept override;
  CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept override;
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::vector<CameraControl> controls() override;
  void set_control(const std::string& control, std::int64_t value) override;
  CameraCounters counters() const noexcept override { return counters_; }

 private:
  struct Buffer {
    void* address = nullptr;
    std::size_t size = 0;
    UniqueFd dmabuf;
  };

  void open();  ///< and configures and streams; throws
  void close() noexcept;
  void map_buffers();
  bool stream_on() noexcept;
  bool restart() noexcept;
  bool queue(std::uint32_t index) noexcept;
  bool give_back() noexcept;
  CameraStatus lose() noexcept;
  CameraStatus try_reopen(Duration timeout) noexcept;
  CameraStatus nothing_came(RobotTime now) noexcept;
  CameraStatus wait_newest(Duration timeout, v4l2_buffer& buffer, std::size_t& taken) noexcept;
  CameraStatus dequeue(v4l2_buffer& buffer) noexcept;
  void describe(const v4l2_buffer& buffer, CameraFrame& out) noexcept;
  void stamp(const v4l2_buffer& buffer, CameraFrame& out) noexcept;
  std::size_t bytes_needed() const noexcept;

  std::string name_;
  const Options options_;
  CameraSettings settings_;
  Clock& clock_;
  v4l2::Calls& calls_;
  v4l2::Device device_;
  v4l2::Format format_;
  std::vector<Buffer> buffers_;
  bool started_ = false, lost_ = false;
  std::optional<std::uint32_t> lent_;  // the buffer of the last frame
  std::optional<std::uint32_t> last_sequence_;
  RobotTime last_frame_, last_try_;
  int hangs_ = 0;  // since the last frame
  std::optional<Duration> exposure_;
  int exposure_age_ = 0;  // frames
  CameraCounters counters_;
};

}  // namespace foresight
