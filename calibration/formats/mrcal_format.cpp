// Source: the description of .cameramodel files in mrcal's documentation. A file is the literal of a Python
// dictionary, which is YAML in flow style but for its byte strings.
#include <Eigen/Geometry>

#include "calibration/formats/lens_coefficients.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight::formats {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLeftName = "left.cameramodel";
constexpr const char* kRightName = "right.cameramodel";
const std::vector<std::string> kModels = {"LENSMODEL_PINHOLE", "LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5",
                                          "LENSMODEL_OPENCV8", "LENSMODEL_OPENCV12"};

// Byte strings hold the solver's own inputs, which nobody but mrcal reads.
std::string without_byte_strings(std::string text) {
  for (auto at = text.find("b'"); at != std::string::npos; at = text.find("b'", at + 1)) {
    const bool starts = at > 0 && std::string_view(" \t\n:").find(text[at - 1]) != std::string_view::npos;
    const auto end = text.find('\'', at + 2);
    if (starts && end != std::string::npos) text.replace(at, end + 1 - at, "''");
  }
  return text;
}

struct PosedCamera {
  CameraModel camera;
  Pose T_camera_reference = Pose::Identity();
};

Pose to_pose(const std::vector<double>& rt) {
  const Eigen::Vector3d r(rt.data()), t(rt.data() + 3);
  Pose T = Pose::Identity();
  if (r.norm() > 0) T.linear() = Eigen::AngleAxisd(r.norm(), r.normalized()).toRotationMatrix();
  T.translation() = t;
  return T;
}

PosedCamera read_one(const fs::path& file) {
  const YamlMap yaml = YamlMap::parse(file, without_byte_strings(read_file(file)));
  const std::string key = yaml.has("lensmodel") ? "lensmodel" : "lens_model";
  const std::string model = yaml.text(key);
  if (std::find(kModels.begin(), kModels.end(), model) == kModels.end())
    throw InputError(yaml.where(key), "the lens model " + in_quotes(model) + " is not known here",
                     "convert it with mrcal-convert-lensmodel " + nearest_word(model, kModels));
  const std::size_t count = model == kModels[0] ? 0 : std::stoul(model.substr(std::string("LENSMODEL_OPENCV").size()));
  const auto all = yaml.numbers("intrinsics", 4 + count);
  PosedCamera out;
  out.camera = perspective({all.begin() + 4, all.end()}, yaml.where("intrinsics"));
  set_pinhole(out.camera, yaml.numbers("imagersize", 2), {all.begin(), all.begin() + 4}, yaml.where("intrinsics"));
  const std::string extrinsics = yaml.has("rt_cam_ref") ? "rt_cam_ref" : "extrinsics";
  if (yaml.has(extrinsics)) out.T_camera_reference = to_pose(yaml.numbers(extrinsics, 6));
  return out;
}

std::string camera_text(const CameraModel& camera, const Pose& T_camera_reference) {
  const auto d = coefficients(camera, {4, 5, 8, 12});
  std::vector<double> intrinsics(camera.lens.begin(), camera.lens.begin() + 4);
  intrinsics.insert(intrinsics.end(), d.begin(), d.end());
  const Eigen::AngleAxisd turn(T_camera_reference.linear());
  const Eigen::Vector3d r = turn.angle() * turn.axis(), t = T_camera_reference.translation();
  return "{\n    'lensmodel':  'LENSMODEL_OPENCV" + std::to_string(d.size()) +
         "',\n\n    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n    'intrinsics': " + list(intrinsics) +
         ",\n\n    # extrinsics are rt_cam_ref: the reference is the left camera\n    'extrinsics': " +
         list({r.x(), r.y(), r.z(), t.x(), t.y(), t.z()}) + ",\n\n    'imagersize': [" + std::to_string(camera.width) +
         ", " + std::to_string(camera.height) + "]\n}\n";
}

}  // namespace

CalibratedCameras read_mrcal(const fs::path& path) {
  if (!fs::is_directory(path)) return {{read_one(path).camera}, Pose::Identity()};
  const PosedCamera left = read_one(path / kLeftName), right = read_one(path / kRightName);
  return {{left.camera, right.camera}, left.T_camera_reference * right.T_camera_reference.inverse()};
}

std::vector<CameraFileText> mrcal_text(const CalibratedCameras& cameras) {
  if (!cameras.pair()) return {{"", camera_text(cameras.left(), Pose::Identity())}};
  return {{kLeftName, camera_text(cameras.left(), Pose::Identity())},
          {kRightName, camera_text(cameras.right(), cameras.T_left_right.inverse())}};
}

}  // namespace foresight::formats
