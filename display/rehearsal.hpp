// Images of nothing in particular, to do with them once all that is done with those of a camera.
#pragma once

#include <optional>
#include <vector>

#include "common/lens.hpp"
#include "scene/posed_frame.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// Of the scene's middle: from some way off, from close by, and from afar again, such that textures get finer and
/// coarser, and parts that may move are elsewhere in each. Patterns with coarse and fine detail, the same in each run.
std::vector<PosedFrame> rehearsal_frames(const SceneModel& scene, const Lens& left, const std::optional<Lens>& right);

}  // namespace foresight
