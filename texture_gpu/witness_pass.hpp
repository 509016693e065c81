// Asks the GPU how bright an image shows the points that tell of the lamp.
#pragma once

#include <span>
#include <vector>

#include "texture_gpu/lamp/witnesses.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

/// One context.
class WitnessPass {
 public:
  WitnessPass();

  void set_witnesses(std::span<const Witness> witnesses);

  /// Red, green and blue of each in the first camera's image, 0 .. 1; negative where it is not seen for certain, or
  /// white. Waits for the GPU.
  std::vector<Eigen::Vector3f> brightness(const SeenInputs& inputs, const Pose& T_world_camera, double depth_tolerance);

 private:
  gl::Program program_;
  gl::BufferTexture witnesses_;
  gl::Buffer values_;
  int count_ = 0;
};

}  // namespace foresight
