// Source: the yaml-formats page of kalibr's wiki.
#include <Eigen/Geometry>

#include "calibration/formats/lens_coefficients.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight::formats {
namespace {

CameraModel read_one(const YamlMap& yaml) {
  const std::string projection = yaml.text("camera_model"), model = yaml.text("distortion_model");
  if (projection != "pinhole")
    throw InputError(yaml.where("camera_model"), "the projection " + in_quotes(projection) + " is not known here",
                     "calibrate with pinhole-radtan or pinhole-equi");
  const auto d = model == "none" && !yaml.has("distortion_coeffs") ? std::vector<double>(4, 0.0)
                                                                   : yaml.numbers("distortion_coeffs");
  CameraModel camera;
  if (model == "radtan" || model == "none")
    camera = perspective(d, yaml.where("distortion_coeffs"));
  else if (model == "equidistant")
    camera = equidistant(d, yaml.where("distortion_coeffs"));
  else
    throw InputError(yaml.where("distortion_model"), "the lens model " + in_quotes(model) + " is not known here",
                     "calibrate with pinhole-radtan or pinhole-equi");
  set_pinhole(camera, yaml.numbers("resolution", 2), yaml.numbers("intrinsics", 4), yaml.where("intrinsics"));
  return camera;
}

std::string camera_text(const CameraModel& camera, int index) {
  const std::string name = "cam" + std::to_string(index);
  const LensParameters& l = camera.lens;
  return "  cam_overlaps: []\n  camera_model: pinhole\n  distortion_coeffs: " + list(coefficients(camera, {4})) +
         "\n  distortion_model: " + (camera.distortion == Distortion::equidistant ? "equidistant" : "radtan") +
         "\n  intrinsics: " + list({l[0], l[1], l[2], l[3]}) + "\n  resolution: [" + std::to_string(camera.width) +
         ", " + std::to_string(camera.height) + "]\n  rostopic: /" + name + "/image_raw\n";
}

}  // namespace

CalibratedCameras read_kalibr(const std::filesystem::path& file) {
  const YamlMap yaml = YamlMap::load(file);
  CalibratedCameras cameras;
  cameras.cameras = {read_one(yaml.map("cam0"))};
  if (yaml.has("cam2"))
    throw InputError(yaml.where("cam2"), "there are more than two cameras", "keep cam0 and cam1 in the file");
  if (!yaml.has("cam1")) return cameras;
  const YamlMap right = yaml.map("cam1");
  cameras.cameras.push_back(read_one(right));
  cameras.T_left_right = right.pose("T_cn_cnm1").inverse();
  return cameras;
}

std::vector<CameraFileText> kalibr_text(const CalibratedCameras& cameras) {
  std::string text = "cam0:\n" + camera_text(cameras.left(), 0);
  if (cameras.pair()) {
    text += "cam1:\n  T_cn_cnm1:\n";
    const Eigen::Matrix4d T_right_left = cameras.T_left_right.inverse().matrix();
    for (int row = 0; row < 4; ++row)
      text += "  - " + list({T_right_left(row, 0), T_right_left(row, 1), T_right_left(row, 2), T_right_left(row, 3)}) +
              "\n";
    std::string own = camera_text(cameras.right(), 1);
    text += own.replace(own.find("[]"), 2, "[0]");
    text.replace(text.find("[]"), 2, "[1]");
  }
  return {{"", text}};
}

}  // namespace foresight::formats
