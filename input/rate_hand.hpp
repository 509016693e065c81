// The pose of a hand, of a device that only says how fast it shall move: keys, sticks, a space mouse.
#pragma once

#include <optional>

#include "input/tracker.hpp"

namespace foresight {

/// Shares of the full speed in the axes of space (x forward, y left, z up), each vector at most 1 long.
struct HandRate {
  Eigen::Vector3d linear{0, 0, 0};
  Eigen::Vector3d angular{0, 0, 0};
};

struct RateHandOptions {
  double speed = 0.15;  ///< m/s, > 0
  double turn = 0.6;    ///< rad/s, > 0
  /// A longer time between two steps moves nothing: nobody knows what the device said meanwhile.
  Duration longest_step = std::chrono::milliseconds(100);
};

/// One thread. Nothing throws or allocates.
class RateHand {
 public:
  explicit RateHand(const RateHandOptions& options = {}) noexcept : options_(options) {}

  /// Goes on at `rate` since the last step, never faster than the full speed; numbers that are none stand for 0. A rate
  /// of 0 leaves the pose as it is, bit for bit.
  const Pose& step(OperatorTime now, const HandRate& rate) noexcept;
  const Pose& pose() const noexcept { return pose_; }
  const RateHandOptions& options() const noexcept { return options_; }

 private:
  RateHandOptions options_;
  Pose pose_ = Pose::Identity();
  std::optional<OperatorTime> last_;
};

/// A stick's deflection (-1 .. 1): 0 within `dead` of its middle, then evenly on to the end. What is no number is 0.
double without_dead_zone(double deflection, double dead) noexcept;

}  // namespace foresight
