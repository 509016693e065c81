// Draws flat prints into a face, finer than the lab's own pictures: a corner must lie where the lens puts it.
#pragma once

#include <span>
#include <vector>

#include "gl/faces.hpp"
#include "gl/program.hpp"
#include "sim/print.hpp"

namespace foresight::sim {

/// A print in GPU memory. Immutable; usable from every context of the share group.
struct PrintPicture {
  explicit PrintPicture(const Print& print);

  gl::Texture texture;  ///< share of bare paper, with mipmaps whose texels lie where they should
  Eigen::Vector2f size_m{0, 0};
};

/// Averages 4 x 4 places of the picture in each pixel of the face: no bias, whatever the tilt. Each print is lit by all
/// of the lamp and of the daylight, evenly changing between its corners. One context.
class PrintPass {
 public:
  PrintPass();

  /// Into the bound framebuffer, over what is there already; expects depth testing as LiveView has it and any vertex
  /// array without attributes. One pose a print.
  void operator()(const gl::Faces& faces, const Pose& T_face_world, std::span<const PrintPicture> prints,
                  std::span<const Pose> T_world_print) const;

 private:
  gl::Program program_;
};

}  // namespace foresight::sim
