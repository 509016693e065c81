// Where a commanded joint will be, by the response of its drive (step_response.hpp), learnt while it moves.
//
//   commands  ______/------           position = response to the commands up to the wanted instant
//   shaft     ________.--'''                     + what the response does not explain (offset, load, drift)
//
// What the response leaves unexplained is carried on: with shares of its newest value and of its means over 20 and 200
// ms (which see through quantisation and noise) that are learnt for each horizon, the rest of its mean over 2 s.
//
// Units: rad and s (m for joints that slide). All times are of one clock, in seconds since an instant of the caller's.
#pragma once

#include <array>
#include <vector>

#include "prediction/calibrated_sigma.hpp"
#include "prediction/step_response.hpp"

namespace foresight {

struct PredictedPosition {
  double position = 0;
  double sigma = 0;  ///< the truth lies within twice of it in 95 % of cases
  bool valid = false;
};

struct JointResponseOptions {
  double expected_delay = 0.02;  ///< s: until something was identified
  double least_step = 0.004;     ///< s: states that come faster are not kept for identification
  double stale = 0.5;            ///< s without a state: what is unexplained is learnt anew
  double farthest = 3;           ///< s ahead of the newest state
};

/// One thread. Only the constructor allocates; no method throws.
class JointResponse {
 public:
  explicit JointResponse(const JointResponseOptions& options = {});

  /// The position that is commanded from `time` on. False where not finite, or not after the one before.
  bool command(double time, double position) noexcept { return commands_.add(time, position); }
  /// The position that was measured at `time`; the commands up to then are known. False likewise.
  bool observe(double time, double position) noexcept;

  /// Learns from the last half minute, some ms of CPU time: every second or so. False, and all stays as it was: too few
  /// states, or none of them moved.
  bool identify() noexcept;
  const ResponseFigures& figures() const noexcept { return figures_; }

  /// The position at `time`, of the states so far and the commands up to `time`.
  PredictedPosition at(double time) const noexcept;

 private:
  struct PredictedAt {
    double time = 0, position = 0, sigma = 0;
  };
  static constexpr std::size_t kHorizons = 4, kMeans = 4;
  using Means = std::array<double, kMeans>;  // of what is unexplained, over longer and longer times
  struct Rest {                              // of one horizon
    Weights weights;
    CalibratedSigma sigma;
    LastOf<PredictedAt> guesses;  // to be judged when their time has come
  };
  void learn_rest(std::size_t first) noexcept;
  void learn_rest(std::size_t first, std::size_t horizon) noexcept;
  double rest(double ahead) const noexcept;
  double sigma(double ahead) const noexcept;
  void judge(const TimedPosition& before, const TimedPosition& now) noexcept;
  void guess() noexcept;

  JointResponseOptions options_;
  PositionHistory commands_, states_;
  TimedPosition newest_;
  bool observed_ = false, identified_ = false;
  StepResponseFit fit_;
  Weights inputs_now_;  // of the model, at the newest state
  Means means_{};
  std::vector<Rest> rests_;          // per horizon
  std::vector<Means> learnt_means_;  // room for learn_rest, per state
  std::vector<double> learnt_unexplained_, learnt_off_;
  ResponseFigures figures_;
};

}  // namespace foresight
