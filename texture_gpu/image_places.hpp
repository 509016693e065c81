// Where images lie on the GPU, from their arrival until nothing more is taken from them.
#pragma once

#include <optional>
#include <vector>

#include "texture_gpu/chart_resolution.hpp"
#include "texture_gpu/published_image.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

/// One frame on the GPU: what the passes ask of it.
struct FrameOnGpu {
  std::vector<PosedImage> images;                          ///< left, right where there is one; without their pixels
  std::vector<std::shared_ptr<CameraInput>> cameras;       ///< of each image
  std::vector<std::shared_ptr<PublishedImage>> published;  ///< each image, as it is lent to the display
  std::vector<AtlasView> views;                            ///< of each image
  SeenInputs inputs;
  bool compared = false;
  bool lent = false;    ///< `published` says all of its images
  double log_gain = 0;  ///< of the left image (exposure.hpp), as the next
  Eigen::Vector2d vignetting{0, 0};
  Eigen::Vector3f white_balance{1, 1, 1};   ///< WhiteBalance::factors()
  std::shared_ptr<const SceneLight> light;  ///< whose shadows were taken out of it; null: none were

  RobotTime time() const { return images.front().time; }
  /// Hands `tones` (SeenInputs::update) to the shaders, and all else of the frame.
  void update_inputs(std::span<const Eigen::Vector3f> tones);
};

/// One thread.
class ImagePlaces {
 public:
  ImagePlaces(const Lens& left, const std::optional<Lens>& right, double largest_margin_px);

  /// Puts the frame's images, all but their pixels, into places that neither `kept` nor a lease of the display needs.
  void place(const PosedFrame& frame, const FrameOnGpu& kept, FrameOnGpu& out);

 private:
  std::shared_ptr<PublishedImage> free_place(std::size_t camera, const FrameOnGpu& kept);

  std::vector<Lens> lenses_;
  double largest_margin_px_;
  std::vector<std::vector<std::shared_ptr<PublishedImage>>> places_;  // of each camera
};

}  // namespace foresight
