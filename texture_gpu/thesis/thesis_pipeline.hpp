// The texture extraction of the thesis (chapters 4 and 5, figure 7.2): one polygon after the other,
// one render pass per step. Kept as the baseline that the texture core is measured against.
//
//   for each image: camera_frame (4.1: load; 4.2: depth of the scene)
//     for each polygon in view:
//       perspective_texture  4.1    its bounding box in the image
//       occlusion            4.2    alpha: visible, occluded, outside (4.5)
//       expansion            5.1    uncertain borders become invalid
//       normalisation        4.3    seen at right angles
//       fusion               4.4    over the texture of earlier images
//       ..._filling          5.2    holes
#pragma once

#include "texture_gpu/extraction_report.hpp"
#include "texture_gpu/thesis/expansion.hpp"
#include "texture_gpu/thesis/fusion.hpp"
#include "texture_gpu/thesis/occlusion.hpp"
#include "texture_gpu/thesis/pyramid_filling.hpp"
#include "texture_gpu/thesis/shader_filling.hpp"

namespace foresight::thesis {

/// Belongs to one thread and one context, the display's: the thesis draws between its extractions.
class Pipeline {
 public:
  /// Throws InputError for a lens that cannot be undistorted onto one plane; RuntimeFailure.
  Pipeline(std::shared_ptr<const SceneModel> scene, const Lens& left, const std::optional<Lens>& right,
           const Options& options, bool software_renderer);

  /// Extracts the textures of one frame, left image first. Blocks until the GPU is done.
  ExtractionReport process(const PosedFrame& frame);

  const PolygonTextures& textures() const { return textures_; }
  const std::shared_ptr<const PolygonBuffers>& polygon_buffers() const { return buffers_; }
  const Options& options() const { return options_; }

  /// From the next image on.
  void fill_holes_by(HoleFilling method) { options_.hole_filling = method; }

  /// The alpha mask of polygon `index` in `image` (left camera) after expansion, for pictures of
  /// single steps: CV_8UC1, its bounding box. Empty where it is not in that image. Changes no texture.
  cv::Mat alpha_mask(const PosedImage& image, std::size_t index, Expansion method, int iterations);

 private:
  struct Camera {
    Camera(const Lens& lens, const std::shared_ptr<const gl::SceneBuffers>& scene)
        : frame(lens, scene), perspective(frame.plane()), expansion(frame.plane()) {}
    CameraFrame frame;
    PerspectiveTexture perspective;
    ExpansionPass expansion;
  };
  void process_image(const PosedImage& image, Camera& camera, ExtractionReport& report);
  void mark_occlusion(const CameraFrame& frame, std::size_t polygon, const Pose& T_camera_node) const;
  void fill(std::size_t polygon);
  void mark(const char* stage);

  std::shared_ptr<const SceneModel> scene_;
  Options options_;
  PolygonTextures textures_;
  std::shared_ptr<const PolygonBuffers> buffers_;
  std::vector<std::unique_ptr<Camera>> cameras_;
  TexelDrawing drawing_;
  Occlusion occlusion_;
  Normalisation normalisation_;
  Fusion fusion_;
  PyramidFilling pyramid_;
  ShaderFilling shader_;
  StageClock clock_;
  std::uint64_t number_ = 0;
};

}  // namespace foresight::thesis
