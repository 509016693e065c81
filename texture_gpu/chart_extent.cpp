#include "texture_gpu/chart_extent.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace foresight {
namespace {

constexpr double kChartPixels = 256;
constexpr double kPercentile = 0.1;
constexpr double kMostChartsAcross = 256;  // of the scene's diagonal

}  // namespace

double chart_extent_for(const SceneModel& scene, const Lens& lens, std::span<const ExpectedView> views) {
  std::vector<std::pair<double, double>> distances;  // distance, area
  double total = 0;
  for (const ExpectedView& view : views) {
    for (std::size_t n = 0; n < scene.nodes().size(); ++n) {
      const Mesh& mesh = scene.nodes()[n].mesh;
      const Pose T_camera_node = view.T_world_camera.inverse() * view.scene.T_world_node[n];
      for (const auto& t : mesh.triangles) {
        std::array<Eigen::Vector3d, 3> p;
        for (std::size_t i = 0; i < 3; ++i) p[i] = T_camera_node * mesh.vertices[t[i]].cast<double>();
        const Eigen::Vector3d center = (p[0] + p[1] + p[2]) / 3;
        const auto pixel = lens.project(center);
        if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() >= lens.width() || pixel->y() >= lens.height())
          continue;
        const double area = (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
        distances.emplace_back(center.norm(), area);
        total += area;
      }
    }
  }
  std::sort(distances.begin(), distances.end());
  double sum = 0;
  for (const auto& [distance, area] : distances) {
    sum += area;
    if (sum >= kPercentile * total)
      return std::max(scene.diagonal() / kMostChartsAcross,
                      kChartPixels * distance / std::max(lens.parameters().fx, lens.parameters().fy));
  }
  return 0;
}

}  // namespace foresight
