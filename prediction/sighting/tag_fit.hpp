// The pose of a thing from the corners of the tag that it carries.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibration/camera/twist.hpp"
#include "calibration/tags/tag_detector.hpp"
#include "calibration/tags/thing_tag.hpp"
#include "common/lens.hpp"

namespace foresight {

/// The tags that one camera saw.
struct TagsSeenBy {
  const Lens* lens = nullptr;
  Pose T_world_camera = Pose::Identity();
  const std::vector<DetectedTag>* tags = nullptr;
};

struct TagFit {
  Pose T_world_thing = Pose::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< of a small motion in the thing's frame (twist.hpp)
};

/// From all corners that all cameras saw together; nothing where none saw it, or where the corners do not agree to
/// some pixels. `corner_px`: standard deviation of a corner. Any thread.
std::optional<TagFit> fit_tag(const ThingTag& tag, std::span<const TagsSeenBy> cameras, double corner_px = 0.15);

}  // namespace foresight
