#include "tests/prediction/judged_future.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {

Judged judge(const FutureWorld& world, std::size_t first) {
  std::vector<double> errors, hold;
  std::size_t inside = 0, invalid = 0;
  const Duration age = world.now() - world.pictures().back().time;
  for (std::size_t k = first; k < world.pictures().size(); ++k) {
    const PredictedRobot& shown = world.pictures()[k];
    if (shown.time > world.now()) break;
    if (shown.status == StateStatus::invalid) {
      ++invalid;
      continue;
    }
    const JointValues truth = world.truth_at(shown.time), last = world.truth_at(shown.time + age + age);
    for (std::size_t i = 0; i < 2; ++i) {
      errors.push_back(std::abs(shown.position[i] - truth[i]));
      hold.push_back(std::abs(last[i] - truth[i]));
      inside += errors.back() <= 2 * shown.sigma[i] ? 1 : 0;
    }
  }
  return {quantile(errors, 0.95), quantile(hold, 0.95),
          static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(errors.size(), 1)), errors.size(),
          invalid};
}

}  // namespace foresight
