#include "gl/level_buffers.hpp"

namespace foresight::gl {
namespace {

struct LevelVertex {
  Eigen::Vector3f place, coarser;
};
static_assert(sizeof(LevelVertex) == 24);

}  // namespace

LevelBuffers::LevelBuffers(const SceneModel& scene, std::shared_ptr<const SceneLevels> levels)
    : levels_(std::move(levels)), sources_(GL_R32UI, 16, "sources of coarser triangles") {
  if (scene.cells()) cells_ = *scene.cells();
  std::vector<LevelVertex> vertices;
  std::vector<std::uint32_t> indices, sources;
  unsigned triangles = 0;
  for (const MeshLevels& node : levels_->nodes()) {
    ranges_.emplace_back();
    const auto base = static_cast<GLint>(vertices.size());
    for (std::size_t v = 0; v < node.vertices.size(); ++v) vertices.push_back({node.vertices[v], node.coarser[v]});
    for (std::size_t l = 0; l < node.levels.size(); ++l) {
      const MeshLevel& level = node.levels[l];
      const std::uint32_t going = l + 1 < node.levels.size() ? node.levels[l + 1].vertex_count
                                                             : static_cast<std::uint32_t>(node.vertices.size());
      ranges_.back().push_back({static_cast<GLsizei>(3 * level.triangles.size()), indices.size(), base,
                                base + static_cast<GLint>(going), triangles,
                                l == 0 ? -1 : static_cast<GLint>(sources.size())});
      for (const auto& t : level.triangles) indices.insert(indices.end(), t.begin(), t.end());
      for (const std::uint32_t source : level.source) sources.push_back(triangles + source);
    }
    if (!node.levels.empty()) triangles += static_cast<unsigned>(node.levels[0].triangles.size());
  }
  places_ = Buffer(vertices.size() * sizeof(LevelVertex), "vertices of levels");
  indices_ = Buffer(indices.size() * sizeof(std::uint32_t), "indices of levels");
  places_.write(std::span<const LevelVertex>(vertices));
  indices_.write(std::span<const std::uint32_t>(indices));
  sources_.assign(std::span<const std::uint32_t>(sources));
}

VertexArray LevelBuffers::create_vertex_array() const {
  VertexArray array = gl::create_vertex_array("levels");
  glVertexArrayVertexBuffer(array.name(), 0, places_.name(), 0, sizeof(LevelVertex));
  glVertexArrayElementBuffer(array.name(), indices_.name());
  for (const GLuint attribute : {0u, 1u}) {
    glEnableVertexArrayAttrib(array.name(), attribute);
    glVertexArrayAttribFormat(array.name(), attribute, 3, GL_FLOAT, GL_FALSE,
                              attribute * static_cast<GLuint>(sizeof(Eigen::Vector3f)));
    glVertexArrayAttribBinding(array.name(), attribute, 0);
  }
  return array;
}

}  // namespace foresight::gl
