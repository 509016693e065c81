// Lets a correction of what is shown flow in: no jump, no more than a stated speed, over in a stated time.
//
//   shown = predicted + offset;   when the prediction jumps by d, the offset jumps by -d: what is shown does not
//
//   offset'' = -2 w offset' - w^2 offset,  |offset'| <= fastest       (critically damped)
//
// With w = 22 / s a single correction d is over to 1 % after 6.64 / w = 0.3 s, and moves by w |d| / e = 8.1 |d| per
// second at most. One that would have to be faster goes at `fastest`, and takes |d| / fastest longer at most.
#pragma once

#include <algorithm>
#include <cmath>

namespace foresight {

/// Of one coordinate. One thread. Neither throws nor allocates.
class CorrectionBlend {
 public:
  static constexpr double kRate = 22;        ///< 1/s
  static constexpr double kSettled = 0.302;  ///< s, to 1 %

  double offset() const noexcept { return offset_; }
  /// The prediction of what is shown changed by `change`.
  void jumped(double change) noexcept { offset_ -= change; }
  void forget() noexcept { offset_ = speed_ = 0; }
  /// `seconds` >= 0 go by; `fastest` > 0, per second.
  void pass(double seconds, double fastest) noexcept {
    const double lead = speed_ + kRate * offset_, decay = std::exp(-kRate * seconds);
    const double next = (offset_ + lead * seconds) * decay;
    const double most = fastest * seconds;
    if (std::abs(next - offset_) <= most) {
      speed_ = (lead - kRate * (offset_ + lead * seconds)) * decay;
      offset_ = next;
    } else {
      speed_ = std::copysign(fastest, next - offset_);
      offset_ += std::copysign(most, next - offset_);
    }
  }

 private:
  double offset_ = 0, speed_ = 0;
};

}  // namespace foresight
