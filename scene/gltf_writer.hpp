// Writes textured meshes as glTF 2.0 (ISO/IEC 12113:2022), one file or three.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

/// A node of the world with its mesh; without triangles it is only a pose.
struct GltfNode {
  std::string name;
  Pose T_world_node = Pose::Identity();    ///< world: z up, as in docs/conventions.md
  std::vector<Eigen::Vector3f> vertices;   ///< metres, in the node's frame
  std::vector<Eigen::Vector2f> texcoords;  ///< one per vertex: 0..1 across the image, v downwards from its top
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Nodes that share one image. It shows light as the camera saw it, so the material is unlit
/// (KHR_materials_unlit; readers without it see a rough, non-metallic surface of these colours), and
/// visible from both sides. A root node turns the world to glTF's y up.
struct GltfModel {
  std::string generator;  ///< the program and its version
  std::vector<GltfNode> nodes;
  std::string png;  ///< the image as the bytes of a PNG file, sRGB
};

/// The bytes of a .glb file, which holds everything.
std::string to_glb(const GltfModel& model);

/// The bytes of a .gltf file and of the .bin file that it names; the image is a file too.
struct GltfFiles {
  std::string gltf, bin;
};
GltfFiles to_gltf(const GltfModel& model, const std::string& bin_name, const std::string& png_name);

}  // namespace foresight
