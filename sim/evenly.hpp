// Numbers of hidden deviations.
#pragma once

#include <random>

namespace foresight::sim {

/// From -size .. size: the generator's own numbers, without the library's distributions, which differ between
/// libraries.
inline double evenly(std::mt19937& random, double size) {
  return size * (2.0 * random() / 4294967295.0 - 1);
}

}  // namespace foresight::sim
