#include "texture_gpu/thesis/polygon_buffers.hpp"

#include <map>

namespace foresight::thesis {

PolygonBuffers::PolygonBuffers(std::shared_ptr<const gl::SceneBuffers> scene, const std::vector<Polygon>& polygons)
    : scene_(std::move(scene)), corners_(GL_RGBA32F, 16, "polygon corners") {
  std::map<int, GLint> base_vertex;
  for (const auto& range : scene_->ranges()) base_vertex[range.node] = range.base_vertex;
  std::vector<std::uint32_t> indices;
  std::vector<Eigen::Vector4f> corners;
  for (const Polygon& polygon : polygons) {
    ranges_.push_back({static_cast<GLsizei>(3 * polygon.triangles.size()), indices.size(), base_vertex.at(polygon.node),
                       static_cast<int>(corners.size()), static_cast<int>(polygon.corners.size())});
    for (const auto& triangle : polygon.triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
    for (const Eigen::Vector3d& corner : polygon.corners) corners.push_back(corner.cast<float>().homogeneous());
  }
  indices_ = gl::Buffer(indices.size() * sizeof(std::uint32_t), "polygon triangles");
  indices_.write(std::span<const std::uint32_t>(indices));
  corners_.assign(std::span<const Eigen::Vector4f>(corners));
}

gl::VertexArray PolygonBuffers::create_vertex_array() const {
  gl::VertexArray array = scene_->create_vertex_array();
  glVertexArrayElementBuffer(array.name(), indices_.name());
  return array;
}

void PolygonBuffers::draw(std::size_t polygon) const {
  const Range& range = ranges_[polygon];
  glDrawElementsBaseVertex(GL_TRIANGLES, range.index_count, GL_UNSIGNED_INT,
                           reinterpret_cast<const void*>(range.first_index * sizeof(std::uint32_t)), range.base_vertex);
}

}  // namespace foresight::thesis
