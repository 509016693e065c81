// Whether texels show what they lie on: by the truth of a synthetic run, not by their colours.
//
// The pipelines are fed with images of one flat colour each, a different one for every image. So
// each texel tells which image it came from; its own place and the pose that the pipeline was given
// tell which pixel it took; and the truth of that image tells what surface point that pixel shows.
#pragma once

#include "scene/ground_truth.hpp"
#include "scene/posed_frame.hpp"
#include "texture_gpu/texture_readback.hpp"
#include "texture_gpu/thesis/polygon_textures.hpp"

namespace foresight {

/// Amounts of surface in texels of 2 mm x 2 mm, so that textures of all resolutions compare.
struct TexelCount {
  double right = 0;
  double wrong = 0;      ///< what the pixel shows lies more than 20 mm from the texel
  double arm_stray = 0;  ///< of the wrong ones: a moving node's picture on a still one

  TexelCount& operator+=(const TexelCount& other);
};

/// The number `index` (0 .. 1023) as a picture of one colour.
cv::Mat coded_picture(const Lens& lens, int index);
/// Of a texel's BGR; -1: not from such a picture.
int decoded(const cv::Vec4b& bgra);

/// One image as a pipeline was given it, with its truth.
struct JudgedImage {
  PosedImage given;  ///< pixels: coded_picture(); the pose may be wrong
  GroundTruth::Surface truth;
  int code = 0;
};

class TexelJudge {
 public:
  explicit TexelJudge(const RunFolder& run);

  /// Counts the texels that were painted from `image`.
  TexelCount count(const TextureReadback& textures, const JudgedImage& image) const;
  TexelCount count(const thesis::PolygonTextures& textures, const JudgedImage& image) const;

 private:
  void judge(const JudgedImage& image, int node, const Eigen::Vector3d& p_node, double area_m2, TexelCount& out) const;

  const RunFolder& run_;
  std::vector<bool> moves_;  // per node, in this run
};

}  // namespace foresight
