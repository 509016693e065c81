// When a command will act: how long the line takes, of how long it took lately.
//
//   delay of the next = median of the last 64 + a (newest - median) + b (mean of the last 8 - median)
//
// a and b are learnt online: on a line that queues, the next message is as late as the newest; on one that only
// jitters, the newest says nothing. How sure that is, is kept calibrated. One outlier moves neither median nor, where
// it stays alone, the weights.
#pragma once

#include "prediction/calibrated_sigma.hpp"
#include "prediction/last_of.hpp"
#include "prediction/online_regression.hpp"

namespace foresight {

struct PredictedDelay {
  double seconds = 0;
  double sigma = 0;  ///< s: within twice of it in 95 % of cases
  bool valid = false;
};

struct LineDelayOptions {
  double stale = 1;     ///< s without a message: nothing is said
  double largest = 60;  ///< s: no delay is longer; what says so is wrong
};

/// One thread. add() and at() neither throw nor allocate. Times are of the receiving end, s since an instant of the
/// caller's.
class LineDelay {
 public:
  explicit LineDelay(const LineDelayOptions& options = {});

  /// A message came at `time`, `delay` after it had been sent (by a clock offset that is known, or half a round trip).
  /// False, and not taken: not finite, negative, too long, or `time` before that of the message before. Messages may
  /// have overtaken each other.
  bool add(double time, double delay) noexcept;
  /// Of a message that is sent at `time`, not before the last one that came.
  PredictedDelay at(double time) const noexcept;

 private:
  static constexpr std::size_t kMost = 64, kFew = 8;
  void predict() noexcept;

  LineDelayOptions options_;
  LastOf<double> delays_{kMost};
  OnlineRegression fit_;
  CalibratedSigma sigma_;
  Weights inputs_;
  double time_ = 0, median_ = 0, expected_ = 0;
};

}  // namespace foresight
