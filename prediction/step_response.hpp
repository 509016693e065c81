// The response of one joint's drive to steps of its command, found from recorded commands and encoders.
//
//   m(t) = c(t - a_n) + sum_k s_k (c(t - a_k) - c(t - a_k+1)) + f tanh(c' / speed)      c: commands
//
//   1 |            s_3 ____ s_4            s_k: the share of a step that is realised at an age of a_k .. a_k+1
//     |       s_2 |                        fine ages about the delay that explains most, coarse ones elsewhere
//   0 |__________|_________________ age    f: friction's share, of the direction of the motion
//
// Any dead time, lag, overshoot and following error that does not depend on where the joint stands is such a response.
// The shares are the regularised least squares of changes over 0.3 s, so that constant offsets between commands and
// encoders do not matter, with a pure delay as the prior. Finite step responses: Ljung, System Identification, 2nd ed.,
// 4.2 and 7.3; regularised: Chen, Ohlsson, Ljung 2012.
//
// Units: rad and s (m for joints that slide). Nothing here allocates or throws.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "prediction/online_regression.hpp"
#include "prediction/position_history.hpp"

namespace foresight {

struct StepResponse {
  static constexpr std::size_t kMostAges = 12;

  double delay = 0;  ///< that explains most
  std::size_t bins = 0;
  std::array<double, kMostAges> ages{};      ///< bins + 1, ascending from 0
  double sparse = PositionHistory::kSparse;  ///< commands farther apart are steps, nearer ones lines
  Weights realised;                          ///< of a step in each bin; then friction's share

  /// That delays by `delay` and does nothing else; no age is more than `reach` beyond it.
  static StepResponse pure_delay(double delay, double reach, double sparse = PositionHistory::kSparse) noexcept;
  /// That of a dead time and a lag of the first order, both >= 0; no age is more than `reach` beyond their sum.
  static StepResponse lagging(double dead_time, double lag, double reach) noexcept;
  /// What `realised` are shares of at `time`, of the commands up to `until`.
  Weights inputs(const PositionHistory& commands, double time, double until) const noexcept;
  /// Where all steps that are older than the ages have led.
  double base(const PositionHistory& commands, double time, double until) const noexcept;
  double output(const PositionHistory& commands, double time) const noexcept {
    return base(commands, time, time) + inputs(commands, time, time).dot(realised);
  }
};

/// What was found, for people. Each with its standard deviation.
struct ResponseFigures {
  double delay = 0, delay_sigma = 0;          ///< s: mean age of a step when it is realised
  double dead_time = 0, dead_time_sigma = 0;  ///< s: of the dead time and lag with the same mean and spread
  double lag = 0;                             ///< s: time constant of that lag
  double unexplained = 0;                     ///< rad, rms: change over 0.3 s beside that of the model
  double explained = 0;                       ///< share of the squares of such changes; little: other commands moved it
  std::size_t samples = 0;                    ///< that these come from; 0: nothing was found yet
};

/// As a joint's key of a rig file (docs/rig-files.md).
std::string to_rig_key(const ResponseFigures& figures);

struct StepResponseFit {
  StepResponse model;
  OnlineRegression regression;
  double first = 0;       ///< s: the first instant that was learnt from
  double squares = 0;     ///< sum of what is left unexplained
  double moved = 0;       ///< sum of the squares of all changes
  double variance = 0;    ///< of one independent error
  std::size_t count = 0;  ///< of changes that this comes from

  /// Standard deviation of a change of the output, of the difference `inputs`, that the shares are the reason of.
  double sigma(const Weights& inputs) const noexcept;
  ResponseFigures figures() const noexcept;
};

/// Some ms of CPU time. Nothing: too few states, or commands that hardly move.
std::optional<StepResponseFit> fit_step_response(const PositionHistory& commands,
                                                 const PositionHistory& states) noexcept;

}  // namespace foresight
