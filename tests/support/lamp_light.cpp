#include "tests/support/lamp_light.hpp"

#include <cmath>

#include "tests/support/small_scene.hpp"

namespace foresight {

Eigen::Vector3d lamp_light(const Lamp& lamp, const reference::RayCaster& caster, const Eigen::Vector3d& p_world,
                           const Eigen::Vector3d& normal, int rays) {
  const Eigen::Vector3d way = lamp.position - p_world, l = way.normalized();
  const double facing = std::max(0.0, normal.dot(l)) / way.squaredNorm();
  if (facing <= 0) return Eigen::Vector3d::Ones();
  const Eigen::Vector3d u = l.unitOrthogonal(), v = l.cross(u);
  int seen = 0;
  const int side = static_cast<int>(std::sqrt(rays));  // rings of as many points each, on circles of equal areas
  for (int i = 0; i < side * side; ++i) {
    const double r = lamp.radius * std::sqrt((i / side + 0.5) / side),
                 a = 2 * M_PI * (i % side + 0.5 * (i / side)) / side;
    const Eigen::Vector3d to = lamp.position + r * (std::cos(a) * u + std::sin(a) * v) - p_world;
    const auto hit = caster.cast(p_world + 1e-6 * normal, to, 1e-5);
    if (!hit || hit->t > 1) ++seen;
  }
  return Eigen::Vector3d::Ones() + lamp.strength * facing * seen / (side * side);
}

Eigen::Vector3d normal_of(const SceneModel& scene, const SceneState& state, int triangle) {
  for (std::size_t i = 0; i < scene.nodes().size(); ++i) {
    const Mesh& mesh = scene.nodes()[i].mesh;
    const auto count = static_cast<int>(mesh.triangles.size());
    if (triangle >= count) {
      triangle -= count;
      continue;
    }
    const auto& t = mesh.triangles[static_cast<std::size_t>(triangle)];
    const Eigen::Vector3f n =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    return state.T_world_node[i].linear() * n.cast<double>().normalized();
  }
  return Eigen::Vector3d::Zero();
}

PosedImage lit_photograph(const SceneModel& scene, const SceneState& state, const Lens& lens,
                          const Pose& T_world_camera, const std::vector<Lamp>& lamps, double light, int rays) {
  const reference::RayCaster caster(scene, state);
  cv::Mat image(lens.height(), lens.width(), CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const auto ray = lens.unproject({x, y});
      if (!ray) continue;
      const Eigen::Vector3d direction = T_world_camera.linear() * *ray;
      const auto hit = caster.cast(T_world_camera.translation(), direction, 0.01);
      if (!hit) continue;
      Eigen::Vector3d normal = normal_of(scene, state, hit->triangle);
      if (normal.dot(direction) > 0) normal = -normal;
      Eigen::Vector3d all = Eigen::Vector3d::Ones();
      for (const Lamp& lamp : lamps)
        all += lamp_light(lamp, caster, hit->p_world, normal, rays) - Eigen::Vector3d::Ones();
      const Eigen::Vector3d bgr =
          paint(hit->node, state.T_world_node[static_cast<std::size_t>(hit->node)].inverse() * hit->p_world);
      for (int c = 0; c < 3; ++c)
        image.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<uchar>(255 * light * bgr[c] * std::pow(all[2 - c], 1 / kResponse));
    }
  return {image, state.time, T_world_camera, state};
}

}  // namespace foresight
