// Instants that somebody gave evenly, and that were stamped with noise.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace foresight {

struct EvenTimes {
  std::vector<double> times;         ///< s, one for each
  double interval = 0, scatter = 0;  ///< s: between two; standard deviation of the stamps about `times`
};

/// The instants that `stamps` (s, increasing) scatter about, if these come at an even interval but for that; some may
/// be missing. An interval that changes slowly is followed. Nothing where they scatter by more than a fifth of their
/// interval or less than a hundredth, or are too few.
std::optional<EvenTimes> even_times(std::span<const double> stamps);

}  // namespace foresight
