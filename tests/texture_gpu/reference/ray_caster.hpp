// What a camera sees, by brute force in double precision.
#pragma once

#include <optional>
#include <vector>

#include "gl/faces.hpp"
#include "scene/scene_model.hpp"

namespace foresight::reference {

/// All triangles of a scene at one instant, seen from both sides.
class RayCaster {
 public:
  RayCaster(const SceneModel& scene, const SceneState& state);

  struct Hit {
    int triangle = 0;  ///< of the whole scene
    int node = 0;
    double t = 0;  ///< in lengths of the direction
    Eigen::Vector3d p_world;
    double edge = 0;  ///< smallest barycentric coordinate: near 0 another triangle may be meant
  };
  /// Nearest hit with t >= `least_t`.
  std::optional<Hit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double least_t) const;

 private:
  struct Triangle {
    int node;
    Eigen::Vector3d a, ab, ac;
  };
  std::vector<Triangle> triangles_;
};

/// One face of a camera as gl::FaceImages holds it, row by row: 1 / z at pixel centres (0: no model)
/// and triangle + 1.
struct FacePicture {
  int width = 0, height = 0;
  std::vector<double> inverse_z;
  std::vector<unsigned> surface;
};
FacePicture draw_face(const gl::Faces& faces, int face, const Pose& T_world_camera, const RayCaster& caster);

}  // namespace foresight::reference
