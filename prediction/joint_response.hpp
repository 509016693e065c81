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
#include <optional>
#include <vector>

#include "prediction/calibrated_sigma.hpp"
#include "prediction/step_response.hpp"

namespace foresight {

struct PredictedPosition {
  double position = 0;
  double sigma = 0;  ///< the truth lies within twice of it in 95 % of cases
  bool valid = false;
  bool assumed = false;  ///< it moves, and nothing was learnt of its drive yet
};

/// A drive's response as an earlier identification found it (ResponseFigures).
struct KnownResponse {
  double dead_time = 0.02, lag = 0;  ///< s; >= 0
  double sigma = 0.02;               ///< s: standard deviation of their sum; > 0
};

struct JointResponseOptions {
  /// Holds from the start, until what was learnt is about as sure of the delay, or contradicts it.
  std::optional<KnownResponse> known = {};
  double least_step = 0.004;  ///< s: states that come faster are not kept for identification
  double stale = 0.5;         ///< s without a state: what is unexplained is learnt anew
  double farthest = 3;        ///< s ahead of the newest state
  double first_sigma = 0.02;  ///< rad or m: until the first errors were seen; > 0
};

/// One thread. Only the constructor allocates; no method throws.
class JointResponse {
 public:
  explicit JointResponse(const JointResponseOptions& options = {});

  /// The position that is commanded from `time` on. False where not finite, or not after the one before.
  bool command(double time, double position) noexcept;
  /// Commands later than `time` were only expected; those that follow are known better. States up to `time` may have
  /// been observed, no later ones.
  void forget_commands_after(double time) noexcept {
    asked_.forget_after(time);
    commands_.forget_after(time);
  }
  /// Nothing is known of the commands and states so far; what was learnt of the drive stays.
  void begin_anew() noexcept {
    asked_.clear();
    commands_.clear();
    observed_ = false;
  }
  /// What was measured after `time` was not the drive's doing: nothing is learnt from it, and what was is learnt anew
  /// without it, as far as what is left allows.
  void forget_states_after(double time) noexcept;
  /// The position that was measured at `time`; the commands up to then are known. Not `typical`: something else than
  /// the drive moved or held the joint, and nothing is learnt of the drive from it. False likewise.
  bool observe(double time, double position, bool typical = true) noexcept;

  /// Learns from the last half minute, some ms of CPU time: every second or so. False, and all stays as it was: too few
  /// states, none of them moved, or what was known before is surer.
  bool identify() noexcept;
  const ResponseFigures& figures() const noexcept { return figures_; }
  /// The speed that the drive does not exceed, though its commands ask for more; infinite where none was seen.
  double largest_speed() const noexcept { return speed_; }
  /// Its response was learnt, or known before.
  bool identified() const noexcept { return learnt_ || options_.known; }
  /// It was learnt of what was observed here.
  bool learnt() const noexcept { return learnt_; }
  /// How far the newest state is from where the commands so far and the usual difference of the last seconds put it:
  /// little, unless something else than the drive moves or holds the joint. 0 before any state.
  double astray() const noexcept { return means_.front() - means_.back(); }

  /// The position at `time`, of the states so far and the commands up to `time`.
  PredictedPosition at(double time) const noexcept;

 private:
  struct PredictedAt {
    double time = 0, unexplained = 0, sigma = 0;
  };
  static constexpr std::size_t kHorizons = 4, kMeans = 4;
  using Means = std::array<double, kMeans>;  // of what is unexplained, over longer and longer times
  struct Rest {                              // of one horizon
    Weights weights;
    CalibratedSigma sigma;
    LastOf<PredictedAt> guesses;  // to be judged when their time has come
    bool is_own = false;          // the sigma was learnt of this horizon's errors
  };
  template <typename Visit>
  void for_each_guess(const Visit& visit) noexcept;
  void limit_commands(PositionHistory& limited, double speed) const noexcept;
  void find_speed(StepResponseFit& best) noexcept;
  void learn_rest(std::size_t first) noexcept;
  void learn_rest(std::size_t first, std::size_t horizon) noexcept;
  double rest(double ahead) const noexcept;
  double sigma(double ahead) const noexcept;
  void judge(const TimedPosition& before, const TimedPosition& now) noexcept;
  void guess() noexcept;

  JointResponseOptions options_;
  PositionHistory asked_, commands_, states_;  // commands as they came, and as the drive can follow them
  PositionHistory tried_;                      // room for find_speed
  double speed_ = std::numeric_limits<double>::infinity();
  TimedPosition newest_;
  KnownResponse assumed_;  // until something was learnt: what is known, or thought of drives of which nothing is
  bool observed_ = false, learnt_ = false;
  StepResponseFit fit_;
  Weights inputs_now_;  // of the model, at the newest state
  Means means_{};
  std::vector<Rest> rests_;          // per horizon
  std::vector<Means> learnt_means_;  // room for learn_rest, per state
  std::vector<double> learnt_unexplained_, learnt_off_;
  ResponseFigures figures_;
};

}  // namespace foresight
