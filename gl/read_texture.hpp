// Textures on the CPU, for whoever measures or compares.
#pragma once

#include <opencv2/core.hpp>

#include "gl/objects.hpp"

namespace foresight::gl {

/// Level 0 of a 2-D texture, or of an array of one layer, as it is, first row first. Waits for the GPU. RGBA8 (also
/// with sRGB) as CV_8UC4 in that order, R8 as CV_8UC1, R32F and DEPTH_COMPONENT32F as CV_32FC1, R32UI as CV_32SC1 (bits
/// as they are). Throws std::invalid_argument: another format.
cv::Mat read_texture(GLuint name);
inline cv::Mat read_texture(const Texture& texture) {
  return read_texture(texture.name());
}

}  // namespace foresight::gl
