// What images have shown of points on which shadows may fall.
#pragma once

#include <vector>

#include "scene/scene_model.hpp"
#include "texture_gpu/lamp/witnesses.hpp"

namespace foresight {

/// What one image has shown of the witnesses.
struct LampRecord {
  using Value = Eigen::Matrix<Eigen::half, 3, 1>;
  std::vector<Pose> T_world_node;
  /// Red, green and blue of each witness, logarithms of 0 .. 1, to 0.1 % and better; NaN: not known. A factor on all of
  /// an image's values does not matter.
  std::vector<Value> log_brightness;

  Eigen::Vector3f value(std::size_t witness) const { return log_brightness[witness].cast<float>(); }
  bool knows(std::size_t witness) const { return !value(witness).hasNaN(); }
};

inline float luma_of(const Eigen::Vector3f& rgb) {
  return rgb.dot(Eigen::Vector3f(0.299f, 0.587f, 0.114f));
}

}  // namespace foresight
