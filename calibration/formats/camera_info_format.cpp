#include <Eigen/Geometry>

#include "calibration/formats/lens_coefficients.hpp"
#include "calibration/formats/rectification.hpp"
#include "common/error.hpp"
#include "scene/camera_info.hpp"

namespace foresight::formats {
namespace {

constexpr const char* kLeft = "camera.yaml";
constexpr const char* kRight = "camera_right.yaml";

std::string matrix(const char* name, int rows, const std::vector<double>& data) {
  return std::string(name) + ":\n  rows: " + std::to_string(rows) +
         "\n  cols: " + std::to_string(data.size() / static_cast<std::size_t>(rows)) + "\n  data: " + list(data) + "\n";
}

template <typename Matrix>
std::vector<double> rows_of(const Matrix& m) {
  std::vector<double> out;
  for (Eigen::Index row = 0; row < m.rows(); ++row)
    for (Eigen::Index col = 0; col < m.cols(); ++col) out.push_back(m(row, col));
  return out;
}

/// `R`, `P`: of the rectified image; of a lone camera the lens without its distortion.
std::string camera_text(const CameraModel& camera, const std::string& name, const Eigen::Matrix3d& R,
                        const Eigen::Matrix<double, 3, 4>& P) {
  const LensParameters& l = camera.lens;
  const bool fish_eye = camera.distortion == Distortion::equidistant;
  const auto d = fish_eye ? coefficients(camera, {4}) : coefficients(camera, {5, 8});
  const std::string model = fish_eye ? "equidistant" : d.size() == 8 ? "rational_polynomial" : "plumb_bob";
  return "image_width: " + std::to_string(camera.width) + "\nimage_height: " + std::to_string(camera.height) +
         "\ncamera_name: " + name + "\n" + matrix("camera_matrix", 3, {l[0], 0, l[2], 0, l[1], l[3], 0, 0, 1}) +
         "distortion_model: " + model + "\n" + matrix("distortion_coefficients", 1, d) +
         matrix("rectification_matrix", 3, rows_of(R)) + matrix("projection_matrix", 3, rows_of(P));
}

std::string lone_text(const CameraModel& camera, const std::string& name) {
  const LensParameters& l = camera.lens;
  Eigen::Matrix<double, 3, 4> P;
  P << l[0], 0, l[2], 0, 0, l[1], l[3], 0, 0, 0, 1, 0;
  return camera_text(camera, name, Eigen::Matrix3d::Identity(), P);
}

}  // namespace

CalibratedCameras read_camera_info_files(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {{to_camera_model(read_camera_info(path).lens)}, Pose::Identity()};
  const CameraInfo right = read_camera_info(path / kRight);
  if (!right.T_left_right)
    throw InputError((path / kRight).string(), "has no T_left_right", "add the pose of the right camera");
  return {{to_camera_model(read_camera_info(path / kLeft).lens), to_camera_model(right.lens)}, *right.T_left_right};
}

std::vector<CameraFileText> camera_info_text(const CalibratedCameras& cameras) {
  if (!cameras.pair()) return {{"", lone_text(cameras.left(), "camera")}};
  const Eigen::Vector3d t = cameras.T_left_right.translation();
  const Eigen::Vector4d q = Eigen::Quaterniond(cameras.T_left_right.linear()).coeffs();
  const std::string pose =
      "T_left_right: {xyz: " + list({t.begin(), t.end()}) + ", quaternion: " + list({q.begin(), q.end()}) + "}\n";
  if (!can_be_rectified(cameras))
    return {{kLeft, lone_text(cameras.left(), "left")}, {kRight, lone_text(cameras.right(), "right") + pose}};
  const Rectification r = rectify(cameras);
  return {{kLeft, camera_text(cameras.left(), "left", r.R_left, r.P_left)},
          {kRight, camera_text(cameras.right(), "right", r.R_right, r.P_right) + pose}};
}

}  // namespace foresight::formats
