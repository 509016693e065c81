#include "gl/scene_buffers.hpp"

#include "scene/solid.hpp"

namespace foresight::gl {

SceneBuffers::SceneBuffers(const SceneModel& scene) : boxes_(scene) {
  if (scene.cells()) cells_ = *scene.cells();
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::uint32_t> indices;
  unsigned triangles = 0;
  for (std::size_t n = 0; n < scene.nodes().size(); ++n) {
    const Mesh& mesh = scene.nodes()[n].mesh;
    if (mesh.triangles.empty()) continue;
    ranges_.push_back({static_cast<int>(n), static_cast<GLsizei>(3 * mesh.triangles.size()), indices.size(),
                       static_cast<GLint>(vertices.size()), triangles, foresight::is_solid(mesh)});
    vertices.insert(vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
    triangles += static_cast<unsigned>(mesh.triangles.size());
  }
  triangles_ = triangles;
  vertices_ = Buffer(vertices.size() * sizeof(Eigen::Vector3f), "scene vertices");
  indices_ = Buffer(indices.size() * sizeof(std::uint32_t), "scene indices");
  vertices_.write(std::span<const Eigen::Vector3f>(vertices));
  indices_.write(std::span<const std::uint32_t>(indices));
}

VertexArray SceneBuffers::create_vertex_array() const {
  VertexArray array = gl::create_vertex_array("scene");
  glVertexArrayVertexBuffer(array.name(), 0, vertices_.name(), 0, sizeof(Eigen::Vector3f));
  glVertexArrayElementBuffer(array.name(), indices_.name());
  glEnableVertexArrayAttrib(array.name(), 0);
  glVertexArrayAttribFormat(array.name(), 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(array.name(), 0, 0);
  return array;
}

}  // namespace foresight::gl
