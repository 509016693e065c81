#include "calibration/camera/camera_result.hpp"

#include <yaml-cpp/yaml.h>
#include <algorithm>

#include "common/error.hpp"
#include "common/exact_number.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

constexpr double kLargestSide = 32768;  // px, as Lens takes it
constexpr double kSameExtent = 1e-6;    // relative; a print that was measured anew is another board

template <typename Numbers>
YAML::Node list_of(const Numbers& numbers) {
  YAML::Node list(YAML::NodeType::Sequence);
  list.SetStyle(YAML::EmitterStyle::Flow);
  for (const double v : numbers) list.push_back(exact_text(v));
  return list;
}

Distortion read_distortion(const YamlMap& yaml) {
  try {
    return parse_distortion(yaml.text("model"));
  } catch (const InputError& error) {
    throw InputError(yaml.where("model"), error.what(), "correct the file");
  }
}

CameraModel read_lens(const YamlMap& yaml) {
  CameraModel camera;
  camera.distortion = read_distortion(yaml);
  const auto size = yaml.numbers("size", 2), focal = yaml.numbers("focal_px", 2), centre = yaml.numbers("centre_px", 2);
  const auto side = [](double v) { return v >= 1 && v <= kLargestSide && v == std::floor(v); };
  if (!side(size[0]) || !side(size[1]))
    throw InputError(yaml.where("size"), "is no image size", "write [width, height] in pixels");
  if (!(focal[0] > 0) || !(focal[1] > 0))
    throw InputError(yaml.where("focal_px"), "the focal lengths must be positive", "calibrate the camera");
  camera.width = static_cast<int>(size[0]);
  camera.height = static_cast<int>(size[1]);
  const auto coefficients = yaml.numbers("distortion", free_parameters(camera.distortion).size() - 4);
  camera.lens = {focal[0], focal[1], centre[0], centre[1]};
  std::copy(coefficients.begin(), coefficients.end(), camera.lens.begin() + 4);
  return camera;
}

}  // namespace

KnownBoard::KnownBoard(const std::vector<Eigen::Vector3d>& p_board, const BoardWarp& its_warp)
    : points(static_cast<int>(p_board.size())), warp(its_warp) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : p_board) box.extend(p);
  if (!box.isEmpty()) extent_m = box.sizes().head<2>();
}

bool KnownBoard::is_laid_out_as(const std::vector<Eigen::Vector3d>& p_board) const {
  const KnownBoard other(p_board, {});
  return other.points == points && (other.extent_m - extent_m).norm() <= kSameExtent * extent_m.norm();
}

YAML::Node to_yaml(const KnownBoard& board) {
  YAML::Node node;
  node["points"] = board.points;
  node["extent_m"] = list_of(board.extent_m);
  node["warp_m"] = list_of(std::array{board.warp.x_m, board.warp.y_m});
  return node;
}

YAML::Node to_yaml(const CameraModel& camera) {
  const LensParameters& l = camera.lens;
  const std::size_t count = free_parameters(camera.distortion).size();
  YAML::Node node;
  node["model"] = to_string(camera.distortion);
  node["size"] = list_of(std::array{double(camera.width), double(camera.height)});
  node["focal_px"] = list_of(std::array{l[0], l[1]});
  node["centre_px"] = list_of(std::array{l[2], l[3]});
  node["distortion"] = list_of(std::span(l).subspan(4, count - 4));
  return node;
}

YAML::Node to_yaml(const CalibratedCameras& cameras) {
  if (!cameras.pair()) return to_yaml(cameras.left());
  YAML::Node node;
  node["left"] = to_yaml(cameras.left());
  node["right"] = to_yaml(cameras.right());
  node["T_left_right"] = to_yaml(cameras.T_left_right);
  return node;
}

YAML::Node to_yaml(const Pose& pose) {
  YAML::Node node;
  node["xyz"] = list_of(pose.translation());
  node["quaternion"] = list_of(Eigen::Quaterniond(pose.linear()).coeffs());
  return node;
}

CameraModel read_camera(const YamlMap& yaml) {
  yaml.require_known({"model", "size", "focal_px", "centre_px", "distortion", "board"});
  return read_lens(yaml);
}

CalibratedCameras read_calibrated_cameras(const YamlMap& yaml) {
  if (!yaml.has("left")) return {{read_camera(yaml)}, Pose::Identity()};
  yaml.require_known({"left", "right", "T_left_right", "board"});
  const auto of = [&](const char* side) {
    const YamlMap map = yaml.map(side);
    map.require_known({"model", "size", "focal_px", "centre_px", "distortion"});
    return read_lens(map);
  };
  return {{of("left"), of("right")}, yaml.pose("T_left_right")};
}

std::optional<KnownBoard> read_known_board(const YamlMap& result) {
  if (!result.has("board")) return std::nullopt;
  const YamlMap map = result.map("board");
  map.require_known({"points", "extent_m", "warp_m"});
  KnownBoard board;
  board.points = map.integer("points");
  const auto extent = map.numbers("extent_m", 2), warp = map.numbers("warp_m", 2);
  board.extent_m = {extent[0], extent[1]};
  board.warp = {warp[0], warp[1]};
  return board;
}

}  // namespace foresight
