#include "calibration/camera/camera_result.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "common/exact_number.hpp"

namespace foresight {
namespace {

constexpr double kLargestSide = 32768;  // px, as Lens takes it

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

}  // namespace

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

YAML::Node to_yaml(const StereoModel& stereo) {
  YAML::Node node;
  node["left"] = to_yaml(stereo.left);
  node["right"] = to_yaml(stereo.right);
  node["T_left_right"] = to_yaml(stereo.T_left_right);
  return node;
}

YAML::Node to_yaml(const Pose& pose) {
  YAML::Node node;
  node["xyz"] = list_of(pose.translation());
  node["quaternion"] = list_of(Eigen::Quaterniond(pose.linear()).coeffs());
  return node;
}

CameraModel read_camera(const YamlMap& yaml) {
  yaml.require_known({"model", "size", "focal_px", "centre_px", "distortion"});
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

StereoModel read_stereo(const YamlMap& yaml) {
  yaml.require_known({"left", "right", "T_left_right"});
  return {read_camera(yaml.map("left")), read_camera(yaml.map("right")), yaml.pose("T_left_right")};
}

}  // namespace foresight
