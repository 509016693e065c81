// Cameras through libcamera: those with a pipeline that V4L2 alone cannot drive, and USB cameras too.
#pragma once

#include "common/clock.hpp"
#include "drivers/camera/libcamera_session.hpp"

namespace foresight {

/// yuyv, nv12, mjpeg and grey. Frames borrow libcamera's buffers, which are mapped; CameraFrame::dmabuf is not set.
///
/// Capture time: libcamera's SensorTimestamp is the start of the first row's exposure, on CLOCK_MONOTONIC with the
/// drivers that there are (they hand the kernel's stamp on); the middle follows from exposure and readout as in
/// V4l2Camera. Controls have libcamera's names in lower case ("exposure_time", in us); fractional ones count
/// thousandths ("analogue_gain_milli").
///
/// After a pause of the caller the newest frame comes, as with V4l2Camera.
///
/// libcamera reports no error when a camera goes: it may signal the loss, or just stall. So a watchdog closes and
/// reopens what delivers nothing; after three times without a frame, or where it cannot be opened, it is lost, and
/// looked for until it returns under its id, which libcamera learns from udevd.
class LibcameraCamera final : public Camera {
 public:
  struct Options {
    std::string device;  ///< id, or model where only one camera has it
    CameraSettings settings;
    Duration hangs_after{1'000'000'000};  ///< without a frame; more than 2 frame periods
    Duration reopen_every{500'000'000};   ///< while lost
  };
  /// Opens nothing yet. `clock` (of CLOCK_MONOTONIC) and `library` must outlive this. Throws InputError (bad option).
  LibcameraCamera(std::string name, const Options& options, Clock& clock, libcam::Library& library = libcam::library());
  ~LibcameraCamera() override;

  const std::string& name() const noexcept override { return name_; }
  void start() override;
  void stop() noexcept override;
  CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept override;
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::vector<CameraControl> controls() override;
  void set_control(const std::string& control, std::int64_t value) override;
  CameraCounters counters() const noexcept override { return counters_; }

 private:
  void open();  ///< throws
  bool reopen() noexcept;
  CameraStatus lose() noexcept;
  CameraStatus try_reopen(Duration timeout) noexcept;
  CameraStatus nothing_came() noexcept;
  bool give_back() noexcept;
  CameraStatus wait_newest(Duration timeout, libcam::Finished& newest, std::size_t& taken) noexcept;
  CameraStatus take(const libcam::Finished& finished) noexcept;
  void describe(const libcam::Finished& finished, CameraFrame& out) const noexcept;
  std::size_t bytes_needed() const noexcept;

  std::string name_;
  const Options options_;
  CameraSettings settings_;
  Clock& clock_;
  libcam::Library& library_;
  std::shared_ptr<libcam::Session> session_;
  bool started_ = false, lost_ = false;
  std::optional<std::size_t> lent_;
  std::optional<std::uint32_t> last_sequence_;
  RobotTime last_frame_, last_try_;
  int hangs_ = 0;  // since the last frame
  CameraCounters counters_;
};

}  // namespace foresight
