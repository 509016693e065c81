// What the shaders that include seen.glsl need: the cameras of one frame.
#pragma once

#include <array>
#include <span>

#include "texture_gpu/camera_input.hpp"

namespace foresight {

/// Uniforms and textures of up to two cameras, bound to the places that seen.glsl names.
class SeenInputs {
 public:
  SeenInputs();

  /// Uploads lens parameters and node poses. `cameras`: one or two, `poses`: as many.
  /// `tones`: factor on the image's values, vignetting a and b (exposure.hpp).
  void update(std::span<const CameraInput* const> cameras, std::span<const PosedImage* const> images,
              std::span<const Eigen::Vector3f> tones);

  /// Binds uniform block `block` and seven texture units from `unit` on, and sets the shared uniforms of `program`.
  void bind(const gl::Program& program, double depth_tolerance, GLuint block = 0, GLuint unit = 0) const;
  /// Binds the first camera's image, to be loaded pixel by pixel, to image unit `image`.
  void bind_pixels(GLuint image) const;
  /// How images are sampled that are bound so from unit 0 on; 0: as their textures say.
  static void sample_images_by(GLuint sampler);

  int camera_count() const { return static_cast<int>(cameras_.size()); }
  const CameraInput& camera(int i) const { return *cameras_[static_cast<std::size_t>(i)]; }
  int node_count() const { return node_count_; }
  GLuint node_poses() const { return node_poses_.texture(); }
  const gl::Buffer& blocks() const { return uniform_; }

 private:
  std::vector<const CameraInput*> cameras_;
  gl::Buffer uniform_;
  gl::BufferTexture node_poses_;
  int node_count_ = 0;
};

}  // namespace foresight
