// The polygons' triangles and corners in GPU memory.
#pragma once

#include <memory>

#include "gl/scene_buffers.hpp"
#include "texture_gpu/thesis/polygons.hpp"

namespace foresight::thesis {

/// Draws single polygons from the vertices of the whole scene. Immutable after construction.
class PolygonBuffers {
 public:
  struct Range {
    GLsizei index_count = 0;
    std::size_t first_index = 0;
    GLint base_vertex = 0;
    int first_corner = 0, corner_count = 0;
  };

  /// `scene` and `polygons` are of the same model.
  PolygonBuffers(std::shared_ptr<const gl::SceneBuffers> scene, const std::vector<Polygon>& polygons);

  const Range& range(std::size_t polygon) const { return ranges_[polygon]; }
  GLuint corners() const { return corners_.texture(); }  ///< RGBA32F, node frame
  const std::shared_ptr<const gl::SceneBuffers>& scene() const { return scene_; }

  /// A vertex array of the current context for draw().
  gl::VertexArray create_vertex_array() const;
  /// With such a vertex array bound.
  void draw(std::size_t polygon) const;

 private:
  std::shared_ptr<const gl::SceneBuffers> scene_;
  gl::Buffer indices_;
  gl::BufferTexture corners_;
  std::vector<Range> ranges_;
};

}  // namespace foresight::thesis
