// The meshes of a scene in GPU memory.
#pragma once

#include <memory>
#include <vector>

#include "gl/objects.hpp"
#include "scene/visibility.hpp"

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
    bool is_solid = false;        ///< from outside, what turns its back is hidden
  };

  explicit SceneBuffers(const SceneModel& scene);

  const std::vector<NodeRange>& ranges() const { return ranges_; }
  std::size_t triangles() const { return triangles_; }
  const NodeBoxes& boxes() const { return boxes_; }
  /// Of the scene; null where it has none.
  const CellGraph* cells() const { return cells_ ? &*cells_ : nullptr; }

  /// A vertex array of the current context: attribute 0 the position, with the element buffer.
  VertexArray create_vertex_array() const;

 private:
  Buffer vertices_, indices_;
  std::vector<NodeRange> ranges_;
  std::size_t triangles_ = 0;
  NodeBoxes boxes_;
  std::optional<CellGraph> cells_;
};

}  // namespace foresight::gl
