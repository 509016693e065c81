#include "scene/scene_writer.hpp"

#include "scene/files.hpp"
#include "scene/number_text.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

template <typename Values>
std::string list(const Values& values, int digits) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "[" : ", ") + number_text(value, digits);
  return out + "]";
}

std::string quoted(std::string name) {
  for (std::size_t at = 0; (at = name.find('\'', at)) != std::string::npos; at += 2) name.insert(at, 1, '\'');
  return "'" + name + "'";
}

std::string mesh_name(std::size_t node) {
  const std::string digits = std::to_string(node);
  return "meshes/" + std::string(digits.size() < 3 ? 3 - digits.size() : 0, '0') + digits + ".ply";
}

std::string cells_yaml(const SceneModel& scene) {
  const CellGraph& graph = *scene.cells();
  std::string text = "cells:\n";
  for (const Cell& cell : graph.cells()) {
    std::string names;
    for (const int node : cell.nodes)
      names += (names.empty() ? "" : ", ") + quoted(scene.nodes()[static_cast<std::size_t>(node)].name);
    const Eigen::Vector3d low = cell.box.min(), high = cell.box.max();
    text += "  - {name: " + quoted(cell.name) + ", box: [" + list(low, 12) + ", " + list(high, 12) + "], nodes: [" +
            names + "]}\n";
  }
  if (!graph.portals().empty()) text += "portals:\n";
  for (const Portal& portal : graph.portals()) {
    std::string corners;
    for (const Eigen::Vector3d& corner : portal.corners) corners += (corners.empty() ? "" : ", ") + list(corner, 12);
    const auto name = [&](std::size_t i) {
      return quoted(graph.cells()[static_cast<std::size_t>(portal.cells[i])].name);
    };
    text += "  - {between: [" + name(0) + ", " + name(1) + "], corners: [" + corners + "]}\n";
  }
  return text;
}

}  // namespace

std::string pose_yaml(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();
  return "{xyz: " + list(p, 12) + ", quaternion: " + list(q, 15) + "}";
}

void write_ply(const fs::path& file, const Mesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\ncomment metres, in the frame of the node\nelement vertex " +
                     std::to_string(mesh.vertices.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& v : mesh.vertices) {
    for (const float value : v) text += number_text(static_cast<double>(value), 9) + " ";
    text.back() = '\n';
  }
  for (const auto& t : mesh.triangles)
    text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  write_text(file, text);
}

void write_model(const fs::path& folder, const SceneModel& scene) {
  fs::create_directory(folder / "meshes");
  std::string text = scene.accuracy() ? "accuracy_m: " + number_text(*scene.accuracy(), 9) + "\n" : "";
  text += "nodes:\n";
  for (std::size_t k = 0; k < scene.nodes().size(); ++k) {
    const Node& node = scene.nodes()[k];
    text += "  - name: " + quoted(node.name) + "\n";
    if (!node.mesh.triangles.empty()) {
      const std::string file = mesh_name(k);
      write_ply(folder / file, node.mesh);
      text += "    mesh: " + file + "\n";
    }
    if (node.parent >= 0)
      text += "    parent: " + quoted(scene.nodes()[static_cast<std::size_t>(node.parent)].name) + "\n";
    text += "    pose: " + pose_yaml(node.T_parent_node) + "\n";
  }
  if (scene.cells()) text += cells_yaml(scene);
  write_text(folder / "scene.yaml", text);
}

}  // namespace foresight
