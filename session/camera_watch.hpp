// The cameras beside the control loop: opened, watched, and what there is to say of them.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "drivers/camera/stereo_camera.hpp"

namespace foresight {

/// The cameras as the view shows them.
struct CameraLine {
  std::string fault;                      ///< why no (good) pairs come, in words; "" where all is well
  std::string last_fault;                 ///< the one before, and how long ago it ended; "" if there was none
  double pairs_per_s = 0;                 ///< over the last second
  std::optional<Duration> age;            ///< of the newest pair, since its capture; nothing before the first
  std::array<std::uint64_t, 2> losses{};  ///< index: Side. Times that a camera went
  StereoStatus status;
};

/// Cameras that fail to start are tried again every 5 s; ones that go while they run come back by themselves (Camera).
/// Nothing that happens to them throws, and nothing waits for them.
///
/// start() gives it a thread of its own. In stepped time step() does the same in the caller's. line() from any thread.
class CameraWatch {
 public:
  using Open = std::function<std::unique_ptr<StereoCamera>()>;
  using Take = std::function<void(const StereoPair&)>;

  /// `open` may take seconds and throw; it and `take`, which must not throw and gets every pair that is watched, are
  /// called on the watch's thread. `clock` must outlive this.
  CameraWatch(Open open, Clock& clock, Take take = {});
  ~CameraWatch() { stop(); }

  void start();
  void stop() noexcept;  ///< waits for a running `open`; then all cameras are closed
  void step() noexcept;  ///< in stepped time, instead of start(): opens, looks once, does not wait
  CameraLine line() const;

 private:
  void run(const std::stop_token& stop) noexcept;
  void try_to_open(bool polled) noexcept;
  void take_in(const std::optional<StereoPair>& pair) noexcept;
  std::string fault_of(const StereoStatus& status, RobotTime now);
  void set_fault(std::string fault, RobotTime now);

  Open open_;
  Clock& clock_;
  Take take_;
  std::unique_ptr<StereoCamera> cameras_;
  RobotTime next_try_;

  mutable std::mutex mutex_;  // all below
  std::condition_variable_any stopped_;
  CameraLine line_;
  std::deque<RobotTime> arrivals_;  // of the last second's pairs
  std::optional<RobotTime> opened_, newest_, last_arrival_, last_ended_;
  RobotTime last_cause_{INT64_MIN};  // when the cameras themselves last gave a reason
  std::string cause_;                // with which the last fault began
  std::array<bool, 2> was_lost_{};
  std::jthread thread_;
};

/// Two lines for the view.
std::string camera_text(const CameraLine& line);

}  // namespace foresight
