#include "display/surface_records.hpp"

#include <Eigen/Geometry>

namespace foresight {

SurfaceRecords::SurfaceRecords(const SurfacePatches& surface)
    : triangle_count_(surface.corners.size()),
      triangles_(GL_RGBA32F, 16, "surface triangles"),
      patches_(GL_RGBA32F, 16, "surface patches") {
  std::vector<Eigen::Vector4f> triangles, patches;
  triangles.reserve(2 * surface.corners.size());
  for (std::size_t t = 0; t < surface.corners.size(); ++t) {
    const auto& c = surface.corners[t];
    const Eigen::Vector3d n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    const int patch = surface.patch_of_triangle[t];
    triangles.push_back(Eigen::Vector4d(n.x(), n.y(), n.z(), n.dot(c[0])).cast<float>());
    triangles.push_back(
        Eigen::Vector4i(patch, surface.patches[static_cast<std::size_t>(patch)].node, 0, 0).cast<float>());
  }
  for (const Patch& p : surface.patches) {
    const auto row = [&](const Eigen::Vector3d& v, double w) {
      patches.push_back(Eigen::Vector4d(v.x(), v.y(), v.z(), w).cast<float>());
    };
    row(p.origin, p.cells.x());
    row(p.eu, p.cells.y());
    row(p.ev, p.first_chart);
    row({p.cell_size().x(), p.cell_size().y(), 0}, 0);
  }
  triangles_.assign(std::span<const Eigen::Vector4f>(triangles));
  patches_.assign(std::span<const Eigen::Vector4f>(patches));
}

}  // namespace foresight
