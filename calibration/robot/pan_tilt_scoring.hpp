// What both ways to calibrate a two-axis head share: from poses (pan_tilt.hpp) and from tags (pan_tilt_tags.hpp).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calibration/robot/pan_tilt.hpp"
#include "common/text.hpp"

namespace foresight {

inline constexpr std::size_t kFewestHeadViews = 8;
inline constexpr double kHeadParameters = 14;  // of the model, without joints

/// `Seen`: PanTiltSample or PanTiltView.
template <typename Seen>
std::vector<PanTiltAngles> angles_of(const std::vector<Seen>& all) {
  std::vector<PanTiltAngles> angles;
  for (const Seen& seen : all) angles.push_back(seen.angles);
  return angles;
}

/// By how much residuals are too small where `parameters` were fitted to `residuals` numbers.
inline double redundancy(double parameters, double residuals) {
  return std::sqrt(std::max(0.1, 1 - parameters / residuals));
}

inline bool has_settled(double now, double before, double share) {
  return std::abs(now - before) < share * now;
}

inline std::vector<double> sigmas_of(const Eigen::MatrixXd& covariance) {
  std::vector<double> sigmas;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) sigmas.push_back(std::sqrt(covariance(i, i)));
  return sigmas;
}

/// Objects to parameters that hardly anything determined, by name.
inline void judge_sigmas(const std::vector<std::string>& names, const std::vector<double>& sigmas, Verdict& verdict) {
  constexpr double kOpen = 0.2;  // rad or m
  std::string open;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!(sigmas[i] < kOpen)) open += (open.empty() ? "" : ", ") + names[i] + " (+- " + readable(sigmas[i], 2) + ")";
  if (!open.empty())
    verdict.object("these parameters of the head stay open: " + open,
                   "sweep both joints further, each at several angles of the other");
}

/// Calls `score` with the index of each of `count` views and a copy of `state` that `fit(state, index)` has solved
/// again without it.
template <typename State, typename Fit, typename Score>
void leave_each_out(std::size_t count, const State& state, Fit fit, Score score) {
  for (std::size_t i = 0; i < count; ++i) {
    State without = state;
    fit(without, static_cast<int>(i));
    score(i, without);
  }
}

/// `solve(options)` with the joints' gains held at 1 and with them estimated; they are believed where the left-out
/// error falls. `ratio(with, without)`: of these errors.
template <typename Options, typename Solve, typename Ratio>
auto choose_gains(Options options, Solve solve, Ratio ratio) {
  constexpr double kFalls = 0.99;
  options.gains = false;
  auto without = solve(options);
  options.gains = true;
  auto with = solve(options);
  const double share = ratio(with, without);
  auto& better = share < kFalls ? with : without;
  better.notes.push_back("gains of the joints are " + std::string(share < kFalls ? "estimated" : "held at 1") +
                         ": with them the left-out error is " + readable(share, 3) + " of that without");
  return std::move(better);
}

}  // namespace foresight
