// The levels of a scene's meshes in GPU memory.
#pragma once

#include <memory>
#include <vector>

#include "gl/objects.hpp"
#include "scene/lod/scene_levels.hpp"

namespace foresight::gl {

/// Two places for each vertex (where it is, and where on the next coarser level), and the triangles of all levels.
/// Immutable; usable from every context of the share group.
class LevelBuffers {
 public:
  struct Range {
    GLsizei index_count = 0;
    std::size_t first_index = 0;
    GLint base_vertex = 0;
    GLint first_going = 0;  ///< vertices from this one on are not in the next coarser level; counted over all nodes
    unsigned first_triangle = 0;  ///< of level 0: in the numbering of the whole scene, node after node
    GLint first_source = -1;      ///< of coarser ones: where in sources() theirs begin
  };

  /// `levels`: of that scene.
  LevelBuffers(const SceneModel& scene, std::shared_ptr<const SceneLevels> levels);

  const std::shared_ptr<const SceneLevels>& levels() const { return levels_; }
  const Range& range(std::size_t node, int level) const { return ranges_[node][static_cast<std::size_t>(level)]; }
  /// Of the scene; null where it has none.
  const CellGraph* cells() const { return cells_ ? &*cells_ : nullptr; }
  /// R32UI: for triangles of coarser levels, a triangle of the scene that belongs to the same part.
  GLuint sources() const { return sources_.texture(); }

  /// A vertex array of the current context: attribute 0 the place, 1 that on the coarser level, with the element
  /// buffer.
  VertexArray create_vertex_array() const;

 private:
  std::shared_ptr<const SceneLevels> levels_;
  std::vector<std::vector<Range>> ranges_;
  std::optional<CellGraph> cells_;
  Buffer places_, indices_;
  BufferTexture sources_;
};

}  // namespace foresight::gl
