#include "scene/run_writer.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "pictures/encode.hpp"
#include "scene/files.hpp"
#include "scene/number_text.hpp"

namespace foresight {
namespace fs = std::filesystem;

std::string time_text(RobotTime time) {
  const std::uint64_t ns = time.ns < 0 ? -static_cast<std::uint64_t>(time.ns) : static_cast<std::uint64_t>(time.ns);
  const std::string digits = std::to_string(ns % 1'000'000'000);
  return (time.ns < 0 ? "-" : "") + std::to_string(ns / 1'000'000'000) + "." + std::string(9 - digits.size(), '0') +
         digits;
}

std::string pose_text(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();  // x y z w
  std::string out;
  for (const double value : p) out += number_text(value, 12) + " ";
  for (const double value : q) out += number_text(value, 15) + " ";
  out.pop_back();
  return out;
}

bool is_file_of_run(const fs::path& relative) {
  constexpr std::array<std::string_view, 10> files{
      "camera.yaml",    "camera_right.yaml", "rgb.txt",    "rgb_right.txt", "nodes.txt",
      "trajectory.txt", "registration.txt",  "scene.yaml", "tags.txt",      "without_pose.txt"};
  const std::string folder = relative.parent_path().string(), name = relative.filename().string();
  if (folder.empty()) return std::ranges::find(files, name) != files.end();
  const std::string stem = relative.stem().string();
  const bool numbered = stem.size() >= 6 && std::ranges::all_of(stem, [](char c) { return c >= '0' && c <= '9'; });
  if (folder == "rgb" || folder == "rgb_right") return numbered && relative.extension() == ".png";
  return folder == "meshes" && relative.extension() == ".ply";
}

RunWriter::RunWriter(fs::path folder, const Lens& left, const std::string& name) : folder_(std::move(folder)) {
  fs::create_directory(folder_ / "rgb");
  write_text(folder_ / "camera.yaml", camera_info_text({left, {}}, name));
}

void RunWriter::add_right_camera(const Lens& right, const Pose& T_left_right, const std::string& name) {
  fs::create_directory(folder_ / "rgb_right");
  write_text(folder_ / "camera_right.yaml", camera_info_text({right, T_left_right}, name));
}

std::string RunWriter::image_name(bool right, std::uint64_t number) {
  const std::string digits = std::to_string(number);
  return (right ? "rgb_right/" : "rgb/") + std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits +
         ".png";
}

void RunWriter::write_image(const std::string& name, const cv::Mat& pixels, std::optional<int> compression) const {
  const std::vector<std::uint8_t> bytes = encode_png(pixels, compression);
  write_bytes(folder_ / name, bytes.data(), bytes.size());
}

std::string& RunWriter::row(List& list, RobotTime time) {
  if (list.size == 0 && list.rows.empty()) list.rows = std::string("# ") + list.heading + "\n";
  return list.rows += time_text(time) + ' ';
}

void RunWriter::add_image(bool right, RobotTime time, const std::string& name) {
  row(right ? right_ : left_, time) += name + '\n';
}

void RunWriter::add_unplaced(RobotTime time, const std::string& name) {
  row(unplaced_, time) += name + '\n';
}

void RunWriter::add_pose(RobotTime time, const Pose& T_world_left) {
  row(trajectory_, time) += pose_text(T_world_left) + '\n';
}

void RunWriter::add_node(RobotTime time, const std::string& node, const Pose& T_world_node) {
  row(nodes_, time) += node + ' ' + pose_text(T_world_node) + '\n';
}

void RunWriter::add_registration(RobotTime time, std::string_view quality, double predicted_px) {
  row(registration_, time) += std::string(quality) + ' ' + number_text(predicted_px, 6) + '\n';
}

void RunWriter::write(List& list) {
  if (list.rows.empty()) return;
  const fs::path file = folder_ / list.file;
  std::ofstream stream(file, list.size == 0 ? std::ios::trunc : std::ios::app);
  stream << list.rows;
  stream.close();
  if (!stream) {
    const int error = errno;
    std::error_code ignored;
    fs::resize_file(file, list.size, ignored);
    for (List* const each : lists()) each->rows.clear();
    throw RuntimeFailure("cannot write " + file.string() + " (" + std::strerror(error) + ")",
                         cure_of_write_error(error));
  }
  list.size += list.rows.size();
  list.rows.clear();
}

void RunWriter::flush() {
  for (List* const list : lists()) write(*list);
}

}  // namespace foresight
