// What the texture thread hands to the display before the textures: the newest images, ready to be looked up.
#pragma once

#include <vector>

#include "scene/posed_frame.hpp"
#include "texture_gpu/camera_input.hpp"
#include "texture_gpu/lease.hpp"
#include "texture_gpu/shadow_map.hpp"

namespace foresight {

/// An image with all that tells which surface points it shows. Written by the texture thread before
/// it is published, then left alone until no lease is out.
struct PublishedImage {
  std::shared_ptr<CameraInput> camera;  ///< pixels, depth and uncertain edges
  PosedImage image;                     ///< where camera and nodes stood; without the pixels
  Eigen::Vector3f tone{1, 0, 0};        ///< 1, vignetting a and b (exposure.hpp)
  /// WhiteBalance::factors_on_image() and factors(): on red, green and blue.
  Eigen::Vector3f white_balance{1, 1, 1}, white_balance_of_textures{1, 1, 1};
  float gain = 1;                           ///< factor on textures that shows this image's exposure
  float sharp = 1;                          ///< SharpnessEstimator::cubic_share()
  std::shared_ptr<const SceneLight> light;  ///< as PublishedTextures::light
  double depth_tolerance = 0;               ///< TextureOptions::depth_tolerance
  double range = 1;                         ///< typical distance of what is seen, m; where images are kept, as the next
  /// R32F, a texel for 2x2 pixels: for how many seconds before this image the surface has looked as it does now, but
  /// for gloss (StillPass).
  gl::Texture still;

  mutable std::atomic<int> leases{0};
};

/// What views look up before they turn to textures.
struct NewestImages {
  Lease<PublishedImage> newest;
  /// Empty where textures hold all that it shows and `newest` does not.
  Lease<PublishedImage> before;
  /// The right camera's newest one and older ones, where TextureOptions::images asks for them.
  std::vector<Lease<PublishedImage>> others;

  mutable std::atomic<int> leases{0};
};

using ImagesLease = Lease<NewestImages>;
using LatestImages = Latest<NewestImages>;

}  // namespace foresight
