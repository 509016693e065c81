#include "tests/texture_gpu/reference/ray_caster.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::reference {

RayCaster::RayCaster(const SceneModel& scene, const SceneState& state) {
  for (std::size_t n = 0; n < scene.nodes().size(); ++n) {
    const Mesh& mesh = scene.nodes()[n].mesh;
    const auto at = [&](std::uint32_t i) -> Eigen::Vector3d {
      return state.T_world_node[n] * mesh.vertices[i].cast<double>();
    };
    for (const auto& t : mesh.triangles)
      triangles_.push_back({static_cast<int>(n), at(t[0]), at(t[1]) - at(t[0]), at(t[2]) - at(t[0])});
  }
}

// Moeller and Trumbore 1997.
std::optional<RayCaster::Hit> RayCaster::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                              double least_t) const {
  std::optional<Hit> best;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const Triangle& triangle = triangles_[i];
    const Eigen::Vector3d p = direction.cross(triangle.ac);
    const double determinant = triangle.ab.dot(p);
    if (std::abs(determinant) < 1e-15) continue;
    const Eigen::Vector3d s = origin - triangle.a;
    const double b1 = s.dot(p) / determinant;
    if (b1 < 0 || b1 > 1) continue;  // most of them, at a third of the cost
    const Eigen::Vector3d q = s.cross(triangle.ab);
    const double b2 = direction.dot(q) / determinant, t = triangle.ac.dot(q) / determinant;
    const double edge = std::min({b1, b2, 1 - b1 - b2});
    if (edge < 0 || t < least_t || (best && t >= best->t)) continue;
    best = Hit{static_cast<int>(i), triangle.node, t, origin + t * direction, edge};
  }
  return best;
}

FacePicture draw_face(const gl::Faces& faces, int face, const Pose& T_world_camera, const RayCaster& caster) {
  FacePicture out{faces.width, faces.height, {}, {}};
  const Eigen::Matrix3d R_world_face = T_world_camera.linear() * gl::Faces::rotation(face).transpose();
  for (int y = 0; y < faces.height; ++y)
    for (int x = 0; x < faces.width; ++x) {
      // With z = 1 along the face's axis, t is the depth.
      const Eigen::Vector3d ray((x - faces.cx) / faces.fx, (y - faces.cy) / faces.fy, 1);
      const auto hit = caster.cast(T_world_camera.translation(), R_world_face * ray, gl::kNearPlane);
      out.inverse_z.push_back(hit ? 1 / hit->t : 0);
      out.surface.push_back(hit ? static_cast<unsigned>(hit->triangle) + 1 : 0);
    }
  return out;
}

}  // namespace foresight::reference
