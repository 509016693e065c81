// How long ago the colours of each page were seen.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "texture_gpu/chart_atlas.hpp"

namespace foresight {

/// One thread.
class PageAges {
 public:
  /// Image number `image` is the newest, taken at `now`; from image number `light_changed` on the light is what it is.
  void update(const std::vector<AtlasChart>& charts, std::int64_t image, RobotTime now, std::int64_t light_changed);

  /// Of each page of the page table as it was then, s before `now`; -1: never seen.
  std::span<const float> seconds() const { return seconds_; }

 private:
  std::deque<RobotTime> image_times_;  // of the last images
  std::vector<float> seconds_;
};

}  // namespace foresight
