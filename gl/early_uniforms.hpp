// Uniforms of compute shaders, read before anything else.
#pragma once

#include <string>

namespace foresight::gl {

/// After what the driver calls a uniform where a shader has an early one of that name.
constexpr const char* kAsGiven = "_given";

/// Mesa's llvmpipe runs eight lanes at a time. Within a branch, or after one that returned, lane 0 may be off, so a
/// uniform is loaded for each lane by itself: some 25 instructions for each component, wherever it is used. At the top
/// of main() it is one load (docs/decisions/0050). So a declaration
///
///   uniform float sharp;
///
/// becomes `uniform float sharp_given; float sharp = min(sharp_given, sharp_given);`, a global that is set when main()
/// begins. A plain copy would be put where it is used, by any compiler; the min() goes, too, but stays until nothing is
/// moved any more. Likewise vectors, matrices and blocks of `CameraBlock` (camera.glsl has its at_start()), one
/// declaration a line; arrays of others, bool and what is opaque stay. Lines keep their numbers.
std::string with_early_uniforms(const std::string& shader);

}  // namespace foresight::gl
