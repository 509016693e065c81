// From a run to what the pipelines take: posed frames, and the surface that textures are made for.
#pragma once

#include <memory>

#include "scene/posed_frame.hpp"
#include "scene/run_folder.hpp"
#include "texture_gpu/surface_patches.hpp"

namespace foresight {

/// Reads the pixels of frame `index` of the run, with poses and scene. Throws InputError.
PosedFrame load_posed_frame(const RunFolder& run, std::size_t index);

/// The model's surface, cut into charts of a size that suits the run's views.
std::shared_ptr<const SurfacePatches> surface_for(const RunFolder& run);

}  // namespace foresight
