// A source of images.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drivers/camera/frame.hpp"

namespace foresight {

enum class CameraStatus : std::uint8_t {
  ok,
  timeout,  ///< nothing came in time; ask again
  lost,     ///< the device is gone or does not deliver; asking again also looks whether it came back
  corrupt,  ///< a frame came, but damaged: skipped and counted
};
const char* to_string(CameraStatus status);

/// What is wanted of a camera, and what it was set to.
struct CameraSettings {
  int width = 640, height = 480;  ///< px, > 0
  double rate = 30;               ///< frames per second, > 0
  PixelFormat format = PixelFormat::yuyv;
  std::map<std::string, std::int64_t> controls;  ///< by name (CameraControl::name), set in order of name
  Duration exposure{0};                          ///< fixed; 0: as the camera chooses by itself
  /// From the first row's readout to the last one's. Negative: unknown, up to a frame period.
  Duration readout{-1};
};

struct CameraControl {
  std::string name;  ///< lower case, words joined by "_": "exposure_time_absolute"
  std::int64_t minimum = 0, maximum = 0, step = 1, value = 0;
};

/// Since start().
struct CameraCounters {
  std::uint64_t frames = 0;    ///< delivered
  std::uint64_t corrupt = 0;   ///< skipped: marked as damaged, or truncated
  std::uint64_t dropped = 0;   ///< good, but a newer one was there when the caller came
  std::uint64_t gaps = 0;      ///< missing in the camera's own count
  std::uint64_t restarts = 0;  ///< of a stream that hung
  std::uint64_t losses = 0;    ///< times that the device went
};

/// A stream that hangs is started anew this often before its device counts as lost.
inline constexpr int kHangsUntilLost = 3;

/// One owner thread calls everything between start() and stop(). Set-up (start, controls) blocks and throws;
/// wait_frame() does not throw.
class Camera {
 public:
  virtual ~Camera() = default;
  virtual const std::string& name() const noexcept = 0;  ///< of the rig, "left"; for messages
  /// Throws InputError (no such device, format, size or control, naming the nearest) or RuntimeFailure.
  virtual void start() = 0;
  virtual void stop() noexcept = 0;  ///< frames that borrow from the camera end here
  /// The next frame, of a device the newest one, into `out`, waiting `timeout` at most; `out` is touched only where the
  /// status is ok. Ends the loan of the frame before.
  virtual CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept = 0;
  virtual const CameraSettings& settings() const noexcept = 0;  ///< in effect after start()
  virtual std::vector<CameraControl> controls() = 0;
  /// Throws InputError (unknown, naming the nearest; out of range) or RuntimeFailure (refused).
  virtual void set_control(const std::string& control, std::int64_t value) = 0;
  virtual CameraCounters counters() const noexcept = 0;
};

}  // namespace foresight
