// The shadows of moving parts in what a camera sees.
#pragma once

#include "gl/camera_block.hpp"
#include "texture_gpu/shadow_map.hpp"
#include "texture_gpu/work_list.hpp"

namespace foresight {

/// For cameras with one kind of lens. One context.
class ShadowPass {
 public:
  explicit ShadowPass(const Lens& lens);

  /// What a camera sees: its block (gl::make_camera_block), depth, and gl::make_lens_rays.
  struct Camera {
    const Lens& lens;
    const gl::Buffer& block;
    const gl::FaceImages& faces;
    const gl::Texture& rays;
    const Pose& T_world_camera;
  };
  void operator()(const Camera& camera, const ShadowMap& map);

  /// RGBA8, of the last camera's size: the factor on red, green and blue; 1 where nothing that moves shades.
  const gl::Texture& light() const { return light_; }

  /// Of the last camera: divides by these factors. Where that is beyond white, the pixel is scaled, alpha says by how
  /// much. RGBA8; level 0.
  void take_out_of(const gl::Texture& image) const;

 private:
  gl::Program reached_, shaded_, shade_, unshade_;
  WorkList near_, blocks_, uneven_;
  gl::Texture light_;
};

}  // namespace foresight
