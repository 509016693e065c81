#include "sim/run_files.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/error.hpp"

namespace foresight::sim {
namespace fs = std::filesystem;
namespace {

std::string yaml(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("{{xyz: [{:.12g}, {:.12g}, {:.12g}], quaternion: [{:.15g}, {:.15g}, {:.15g}, {:.15g}]}}", p.x(),
                     p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

std::string ply(const Mesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\ncomment metres, in the frame of the node\n";
  text +=
      fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n", mesh.vertices.size());
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.size());
  for (const auto& v : mesh.vertices) text += fmt::format("{:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  for (const auto& t : mesh.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

}  // namespace

void write_bytes(const fs::path& file, const void* data, std::size_t size) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  stream.close();
  if (!stream)
    throw RuntimeFailure("cannot write " + file.string() + " (" + std::strerror(errno) + ")", "free some disk space");
}

void write_text(const fs::path& file, const std::string& text) {
  write_bytes(file, text.data(), text.size());
}

std::string pose_text(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("{:.12g} {:.12g} {:.12g} {:.15g} {:.15g} {:.15g} {:.15g}", p.x(), p.y(), p.z(), q.x(), q.y(),
                     q.z(), q.w());
}

std::string camera_yaml(const Lens& lens, const std::string& name, const Pose* T_left_right) {
  const auto& p = lens.parameters();
  std::string text = fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", p.width, p.height, name);
  text +=
      fmt::format("camera_matrix:\n  rows: 3\n  cols: 3\n  data: [{:.17g}, 0, {:.17g}, 0, {:.17g}, {:.17g}, 0, 0, 1]\n",
                  p.fx, p.cx, p.fy, p.cy);
  text += "distortion_model: " + to_string(p.model) + "\n";
  const int count = p.model == LensModel::equidistant ? 4 : 5;
  text += fmt::format("distortion_coefficients:\n  rows: 1\n  cols: {}\n  data: [{:.17g}", count, p.d[0]);
  for (int i = 1; i < count; ++i) text += fmt::format(", {:.17g}", p.d[static_cast<std::size_t>(i)]);
  text += "]\n";
  if (T_left_right) text += "T_left_right: " + yaml(*T_left_right) + "\n";
  return text;
}

void write_model(const fs::path& folder, const SceneModel& scene) {
  fs::create_directory(folder / "meshes");
  const auto quoted = [](std::string name) {
    for (std::size_t at = 0; (at = name.find('\'', at)) != std::string::npos; at += 2) name.insert(at, 1, '\'');
    return "'" + name + "'";
  };
  std::string text = scene.accuracy() ? fmt::format("accuracy_m: {:.9g}\n", *scene.accuracy()) : "";
  text += "nodes:\n";
  for (std::size_t k = 0; k < scene.nodes().size(); ++k) {
    const Node& node = scene.nodes()[k];
    text += "  - name: " + quoted(node.name) + "\n";
    if (!node.mesh.triangles.empty()) {
      const std::string file = fmt::format("meshes/{:03}.ply", k);
      write_text(folder / file, ply(node.mesh));
      text += "    mesh: " + file + "\n";
    }
    if (node.parent >= 0)
      text += "    parent: " + quoted(scene.nodes()[static_cast<std::size_t>(node.parent)].name) + "\n";
    text += "    pose: " + yaml(node.T_parent_node) + "\n";
  }
  write_text(folder / "scene.yaml", text);
}

void write_scene(const fs::path& folder, const Lab& lab, const ArmPosition& arm) {
  fs::create_directory(folder / "meshes");
  std::string text = "accuracy_m: 0.004  # the model is exact; this tells thin parts from what they lie on\nnodes:\n";
  for (int k = 0; k < static_cast<int>(lab.parts.size()); ++k) {
    const Part& part = lab.parts[static_cast<std::size_t>(k)];
    write_text(folder / "meshes" / (part.name + ".ply"), ply(mesh_of(part)));
    if (k >= lab.arm && k < lab.arm + kArmLinks) continue;  // in the robot
    text += "  - name: " + part.name + "\n    mesh: meshes/" + part.name + ".ply\n";
    text += "    pose: " + yaml(part.T_world_part) + "\n";
  }
  text += "robots:\n  - urdf: arm.urdf\n    pose: " + yaml(T_world_stand()) + "\n    joints: {";
  for (std::size_t j = 0; j < arm.joints.size(); ++j)
    text += fmt::format("{}: {:.12g}, ", arm_joints()[j].name, arm.joints[j]);
  text += fmt::format("{}: {:.12g}}}\n", arm_joints()[arm.joints.size()].name, arm.opening);
  write_text(folder / "arm.urdf", arm_urdf());
  write_text(folder / "scene.yaml", text);
}

}  // namespace foresight::sim
