// The scene as a camera with a real lens would see it, with published textures.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "display/surface_records.hpp"
#include "gl/camera_block.hpp"
#include "gl/program.hpp"
#include "gl/raster_pass.hpp"
#include "texture_gpu/published_textures.hpp"

namespace foresight {

/// Renders through one lens. First the scene's triangles are rasterised into pinhole faces; then
/// each pixel follows its own ray through the lens model to the triangle seen there, to the exact
/// point on it, to its texels: one filter between texture and picture, none for the lens.
/// Belongs to one context, in a share group with the texture core's.
class PredictedView {
 public:
  PredictedView(std::shared_ptr<const gl::SceneBuffers> scene, std::shared_ptr<const SurfaceRecords> surface,
                const Lens& lens);

  /// Draws into picture(). `textures` must stay leased until the GPU has finished.
  void draw(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures);

  /// RGBA8, straight alpha, row 0 at the top: 255 colour from a camera image, 128 filled hole,
  /// 64 model without any colour, 0 no model.
  const gl::Texture& picture() const { return picture_; }

  /// Waits for the GPU; CV_8UC4 in BGRA order.
  cv::Mat read() const;

  /// The triangle seen at each pixel of the last draw()'s faces (gl::FaceImages::surface).
  const gl::FaceImages& faces() const { return faces_; }

 private:
  Lens lens_;
  std::shared_ptr<const SurfaceRecords> surface_;
  gl::FaceImages faces_;
  gl::RasterPass raster_;
  gl::Program program_;
  gl::Buffer camera_;
  gl::BufferTexture node_poses_;  // T_node_camera: three rows a node
  gl::Texture rays_;              // RGB32F directions, only for lenses with distortion
  gl::Texture picture_;
};

}  // namespace foresight
