// How well a FutureWorld's robot was shown.
#pragma once

#include <string>
#include <vector>

#include "tests/prediction/future_world.hpp"

namespace foresight {

inline const std::vector<std::string> kFutureNames{"turn", "wave"};  ///< of its joints

struct Judged {
  double p95 = 0, hold_p95 = 0, inside = 0;  // rad; of both joints
  std::size_t count = 0, invalid = 0;
};

/// Of the pictures from the first one of that index on, but for those whose time has not come.
Judged judge(const FutureWorld& world, std::size_t first);

}  // namespace foresight
