// The framebuffer of section 4.1: the undistorted camera image with an alpha channel, and the
// scene's depth from the same pose.
#pragma once

#include "texture_gpu/camera_input.hpp"
#include "texture_gpu/thesis/texel_drawing.hpp"

namespace foresight::thesis {

/// alpha^p_BB of section 4.5.3: neither visible (1) nor occluded (0). As 8-bit values hold it: 247/255.
inline constexpr float kOutsideAlpha = 31.0f / 32.0f;

/// One camera's. Belongs to one context. Throws std::invalid_argument from the constructor: a lens
/// that sees too much for one plane (undistorted images need a pinhole).
class CameraFrame {
 public:
  CameraFrame(const Lens& lens, const std::shared_ptr<const gl::SceneBuffers>& scene);

  /// True where one picture plane can hold all that the lens sees.
  static bool can_undistort(const Lens& lens);

  /// Starts the image's way to the GPU: the only image data that crosses (section 4.1).
  void upload(const PosedImage& image);

  /// Straightens the image into the framebuffer (where its lens distorts) and marks all of it as
  /// outside (alpha 31/32).
  void load(const TexelDrawing& drawing);

  /// Draws the scene's depth (section 4.2.2). What the lens does not see counts as occluded.
  void draw_depth(const PosedImage& image, const TexelDrawing& drawing);

  /// Sets alpha back to 31/32 in a rectangle of pixels.
  void reset_alpha(int x, int y, int width, int height) const;

  /// Binds the framebuffer, alpha the only channel that is written.
  void bind_alpha() const;

  const gl::Faces& plane() const { return input_.faces().faces; }                       ///< size and intrinsics, px
  const gl::Texture& colour() const { return straight_ ? straight_ : input_.image(); }  ///< RGBA8
  const gl::Texture& depth() const { return input_.faces().depth; }                     ///< one layer, near / z

 private:
  CameraInput input_;
  gl::RasterPass raster_;
  gl::Texture straight_;  // only for lenses with distortion
  gl::Framebuffer framebuffer_, depth_only_;
  gl::KeptFences fences_;
  gl::Program undistort_, unseen_;
};

}  // namespace foresight::thesis
