// The meshes of a scene in GPU memory.
#pragma once

#include <memory>
#include <vector>

#include "gl/objects.hpp"
#include "scene/scene_model.hpp"

namespace foresight::gl {

/// Vertices (vec3, node frame) and indices of all nodes in one buffer each. Immutable after
/// construction; usable from every context of the share group.
class SceneBuffers {
 public:
  struct NodeRange {
    int node = 0;  ///< index in SceneModel::nodes()
    GLsizei index_count = 0;
    std::size_t first_index = 0;
    GLint base_vertex = 0;
    unsigned first_triangle = 0;  ///< in the numbering of the whole scene, node after node
  };

  explicit SceneBuffers(const SceneModel& scene);

  const std::vector<NodeRange>& ranges() const { return ranges_; }

  /// A vertex array of the current context: attribute 0 the position, with the element buffer.
  VertexArray create_vertex_array() const;

 private:
  Buffer vertices_, indices_;
  std::vector<NodeRange> ranges_;
};

}  // namespace foresight::gl
