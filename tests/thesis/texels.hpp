// Texels to and from textures, for the steps of the thesis' pipeline.
#pragma once

#include <opencv2/core.hpp>

#include "gl/objects.hpp"

namespace foresight {

/// Writes CV_8UC4 (R, G, B, A) to the first texels of an RGBA8 texture.
void write_texels(const gl::Texture& texture, const cv::Mat& texels);

/// The first width x height texels: CV_8UC4 (R, G, B, A). Waits for the GPU.
cv::Mat read_texels(const gl::Texture& texture, int width, int height);

/// Random colours with alpha 0 in some blots and 255 elsewhere.
cv::Mat blotted_texels(int width, int height, unsigned seed);

}  // namespace foresight
