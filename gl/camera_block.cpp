#include "gl/camera_block.hpp"

namespace foresight::gl {

CameraBlock make_camera_block(const Lens& lens, const Faces& faces) {
  const auto& p = lens.parameters();
  const auto f = [](double v) { return static_cast<float>(v); };
  CameraBlock block;
  block.focal = Eigen::Vector4d(p.fx, p.fy, p.cx, p.cy).cast<float>();
  float model = 0;
  if (p.model == LensModel::equidistant) {
    model = 2;
    block.radial = Eigen::Vector4d(p.d[0], p.d[1], p.d[2], p.d[3]).cast<float>();
  } else {
    model = lens.has_distortion() ? 1.0f : 0.0f;
    block.radial = Eigen::Vector4d(p.d[0], p.d[1], p.d[4], 0).cast<float>();
    block.radial_denominator = Eigen::Vector4d(p.d[5], p.d[6], p.d[7], 0).cast<float>();
    block.tangential.head<2>() = Eigen::Vector2d(p.d[2], p.d[3]).cast<float>();
  }
  block.tangential[2] = model;
  block.tangential[3] = f(lens.max_radius());
  block.size = Eigen::Vector4i(p.width, p.height, faces.width, faces.height).cast<float>();
  block.face = Eigen::Vector4d(faces.fx, faces.fy, faces.cx, faces.cy).cast<float>();
  block.tone = {1, 0, 0, static_cast<float>(faces.count)};
  return block;
}

std::vector<std::string> camera_defines(std::span<const Lens> lenses) {
  const auto kind = [](const Lens& lens) {
    const int model = lens.model() == LensModel::equidistant ? 2 : lens.has_distortion() ? 1 : 0;
    return std::pair(model, faces_for(lens, 0).count > 1 ? 1 : 0);
  };
  const auto [model, cube] = kind(lenses[0]);
  for (const Lens& lens : lenses)
    if (kind(lens) != std::pair(model, cube)) return {};
  const bool face_is_image = model == 0 && cube == 0;  // faces_for()
  return {"LENS_MODEL " + std::to_string(model), "CUBE_FACES " + std::to_string(cube),
          "FACE_IS_IMAGE " + std::to_string(face_is_image ? 1 : 0)};
}

void append_node_rows(const Pose& T_world_camera, const SceneState& state, std::vector<Eigen::Vector4f>& out) {
  const Pose T_camera_world = T_world_camera.inverse();
  for (const Pose& T_world_node : state.T_world_node) {
    const Eigen::Matrix4f m = (T_camera_world * T_world_node).matrix().cast<float>();
    for (int row = 0; row < 3; ++row) out.push_back(m.row(row).transpose());
  }
}

}  // namespace foresight::gl
