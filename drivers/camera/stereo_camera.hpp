// Two cameras as one: the newest pair of images.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/clock.hpp"
#include "common/latest_value.hpp"
#include "drivers/camera/camera.hpp"
#include "drivers/camera/stereo_pairing.hpp"

namespace foresight {

struct StereoStatus {
  std::array<CameraStatus, 2> cameras{CameraStatus::timeout, CameraStatus::timeout};  ///< index: Side; the last one
  std::array<std::uint64_t, 2> corrupt{};  ///< damaged images, found by the camera or by the conversion
  PairingCounters pairing;
  std::uint64_t dropped = 0;  ///< pairs that nobody took in time
  const char* reason = "";    ///< why no pairs come; static text, "" where all is well
};

/// Two threads own a camera each: they wait for its images, convert them and pair them. A slow consumer gets the
/// newest pair, never a queue of old ones. Needs a clock that may be waited for in several threads; with a
/// SteppedClock, start_polled() and poll() do the same in the caller's thread.
class StereoCamera {
 public:
  /// `clock` must outlive this, and be the one of the cameras' capture times.
  StereoCamera(std::unique_ptr<Camera> left, std::unique_ptr<Camera> right, const Clock& clock,
               const PairingOptions& options = {});
  ~StereoCamera();

  /// Starts both; throws what Camera::start() throws, and then none runs.
  void start();
  void start_polled();   ///< starts both, without threads
  void poll() noexcept;  ///< takes in what both have now, without waiting; only after start_polled()
  void stop() noexcept;  ///< waits up to 0.1 s and a conversion for the threads
  /// The newest pair not yet taken, waiting `timeout` at most. Any thread.
  std::optional<StereoPair> take(Duration timeout) noexcept { return newest_.take(timeout); }
  StereoStatus status() const noexcept;  ///< any thread

 private:
  void run(const std::stop_token& stop, Side side) noexcept;
  CameraStatus look(Side side, Duration timeout) noexcept;

  std::array<std::unique_ptr<Camera>, 2> cameras_;
  const Clock& clock_;
  mutable std::mutex mutex_;  // pairing_
  StereoPairing pairing_;
  LatestValue<StereoPair> newest_;
  std::array<std::atomic<CameraStatus>, 2> statuses_{CameraStatus::timeout, CameraStatus::timeout};
  std::array<std::atomic<std::uint64_t>, 2> corrupt_{};
  bool polled_ = false;
  std::array<std::jthread, 2> threads_;
};

/// What keeps pairs from coming, in words for the user, such as "the left camera is lost: ..."; "" where nothing does.
std::string fault_text(const StereoStatus& status);

}  // namespace foresight
