// The textured surface as the view shader reads it.
#pragma once

#include "gl/objects.hpp"
#include "texture_gpu/surface_patches.hpp"

namespace foresight {

/// Two texels per triangle (its plane in the node's frame; patch and node) and four per patch.
/// Immutable; usable from every context of the share group.
class SurfaceRecords {
 public:
  explicit SurfaceRecords(const SurfacePatches& surface);
  std::size_t triangle_count() const { return triangle_count_; }
  GLuint triangles() const { return triangles_.texture(); }
  GLuint patches() const { return patches_.texture(); }

 private:
  std::size_t triangle_count_;
  gl::BufferTexture triangles_, patches_;
};

}  // namespace foresight
