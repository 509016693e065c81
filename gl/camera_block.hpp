// A camera as shaders see it: the C++ twin of `CameraBlock` in camera.glsl.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "common/lens.hpp"
#include "gl/faces.hpp"
#include "gl/objects.hpp"
#include "scene/scene_model.hpp"

namespace foresight::gl {

/// std140 layout; every member is a vec4.
struct CameraBlock {
  Eigen::Vector4f focal = Eigen::Vector4f::Zero();               ///< fx fy cx cy of the lens, px
  Eigen::Vector4f radial = Eigen::Vector4f::Zero();              ///< numerator k1 k2 k3; equidistant: k1 k2 k3 k4
  Eigen::Vector4f radial_denominator = Eigen::Vector4f::Zero();  ///< k4 k5 k6
  Eigen::Vector4f tangential = Eigen::Vector4f::Zero();  ///< p1 p2, model (0 none 1 rational 2 equidistant), max radius
  Eigen::Vector4f size = Eigen::Vector4f::Zero();        ///< image width, height; face width, height; px
  Eigen::Vector4f face = Eigen::Vector4f::Zero();        ///< fx fy cx cy of the faces, px
  Eigen::Vector4f tone = Eigen::Vector4f::Zero();  ///< see texture_gpu/exposure.hpp: factor, vignetting a and b; faces
};
static_assert(sizeof(CameraBlock) == 7 * 16);

CameraBlock make_camera_block(const Lens& lens, const Faces& faces);

/// Defines for programs that serve these cameras only; empty where the cameras differ in kind.
std::vector<std::string> camera_defines(std::span<const Lens> lenses);

/// Rows of T_camera_node (3 x vec4 per node), appended to `out` for the samplerBuffer `node_poses`.
void append_node_rows(const Pose& T_world_camera, const SceneState& state, std::vector<Eigen::Vector4f>& out);

}  // namespace foresight::gl
