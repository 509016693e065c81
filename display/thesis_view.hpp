// The scene with the textures of the thesis' pipeline.
#pragma once

#include "gl/camera_block.hpp"
#include "texture_gpu/thesis/thesis_pipeline.hpp"

namespace foresight {

/// Draws every polygon with its own texture, bilinearly filtered, into a picture plane, and from
/// there through the lens where it distorts. Belongs to the pipeline's context.
class ThesisView {
 public:
  /// `pipeline` must outlive this. The lens must fit one picture plane (CameraFrame::can_undistort).
  ThesisView(const thesis::Pipeline& pipeline, const Lens& lens);

  void draw(const Pose& T_world_camera, const SceneState& state);

  /// RGBA8 with alpha as in PredictedView::picture(), row 0 at the top.
  const gl::Texture& picture() const { return picture_ ? picture_ : drawn_; }

  /// Waits for the GPU; CV_8UC4 (BGRA).
  cv::Mat read() const;

 private:
  const thesis::Pipeline& pipeline_;
  Lens lens_;
  gl::Faces plane_;
  gl::Texture drawn_, depth_, rays_, picture_;
  gl::Texture nothing_;  // of polygons without colours: where no texture is bound, shaders read opaque black
  gl::Buffer camera_;
  gl::Framebuffer framebuffer_;
  gl::VertexArray triangles_;
  gl::Program textured_, through_lens_;
  thesis::TexelDrawing drawing_;
};

}  // namespace foresight
