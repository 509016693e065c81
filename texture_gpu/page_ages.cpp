#include "texture_gpu/page_ages.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr std::size_t kTimesKept = 4096;  // images; what was seen before them is taken as seen with the oldest

}  // namespace

void PageAges::update(const std::vector<AtlasChart>& charts, std::int64_t image, RobotTime now,
                      std::int64_t light_changed) {
  image_times_.push_back(now);
  if (image_times_.size() > kTimesKept) image_times_.pop_front();
  const std::int64_t oldest = image + 1 - static_cast<std::int64_t>(image_times_.size());
  const auto age_of = [&](std::int64_t seen) {
    const auto at = static_cast<std::size_t>(std::max(seen - oldest, std::int64_t{0}));
    return static_cast<float>(to_seconds(now - image_times_[at]));
  };
  seconds_.clear();
  for (const AtlasChart& chart : charts)
    for (const AtlasPage& page : chart.page) {
      // Colours in another light are as old as they are, however often the page was seen since.
      const bool in_old_light = page.written >= 0 && page.written < light_changed;
      const std::int64_t seen = in_old_light ? page.written : page.last_seen;
      seconds_.push_back(seen < 0 ? -1.0f : age_of(seen));
    }
}

}  // namespace foresight
