// Names as OpenCV's own calibration samples write them.
#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

#include "calibration/formats/lens_coefficients.hpp"
#include "calibration/formats/rectification.hpp"
#include "common/error.hpp"
#include "scene/files.hpp"

namespace foresight::formats {
namespace {

namespace fs = std::filesystem;

std::vector<double> numbers(const cv::FileStorage& storage, const std::string& key, const fs::path& file) {
  cv::Mat m;
  const cv::FileNode node = storage[key];
  if (!node.empty() && node.isMap()) node >> m;
  if (m.empty() || m.channels() != 1)
    throw InputError(file.string() + ": " + key, "is missing or no matrix", "write it as OpenCV's samples do");
  m.convertTo(m, CV_64F);
  std::vector<double> out;
  for (auto it = m.begin<double>(); it != m.end<double>(); ++it) out.push_back(*it);
  for (const double v : out)
    if (!std::isfinite(v)) throw InputError(file.string() + ": " + key, "is not finite", "correct the file");
  return out;
}

CameraModel read_one(const cv::FileStorage& storage, const std::string& matrix, const std::string& d,
                     const fs::path& file) {
  const auto k = numbers(storage, matrix, file), coefficients = numbers(storage, d, file);
  if (k.size() != 9 || k[1] != 0)
    throw InputError(file.string() + ": " + matrix, "is no camera matrix without skew",
                     "write fx 0 cx, 0 fy cy, 0 0 1");
  const bool fish_eye = !storage["fisheye_model"].empty() && static_cast<int>(storage["fisheye_model"]) != 0;
  const std::string where = file.string() + ": " + d;
  CameraModel camera = fish_eye ? equidistant(coefficients, where) : perspective(coefficients, where);
  const auto side = [&](const char* key) { return storage[key].empty() ? 0.0 : static_cast<double>(storage[key]); };
  set_pinhole(camera, {side("image_width"), side("image_height")}, {k[0], k[4], k[2], k[5]}, file.string());
  return camera;
}

CalibratedCameras read_storage(const cv::FileStorage& storage, const fs::path& file) {
  if (storage["M1"].empty())
    return {{read_one(storage, "camera_matrix", "distortion_coefficients", file)}, Pose::Identity()};
  CalibratedCameras cameras;
  cameras.cameras = {read_one(storage, "M1", "D1", file), read_one(storage, "M2", "D2", file)};
  const auto R = numbers(storage, "R", file), T = numbers(storage, "T", file);
  if (R.size() != 9 || T.size() != 3)
    throw InputError(file.string(), "R and T are no rotation and translation", "write 3x3 and 3x1 numbers");
  Pose T_right_left = Pose::Identity();
  T_right_left.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  T_right_left.translation() = Eigen::Vector3d(T.data());
  if ((T_right_left.linear() * T_right_left.linear().transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-6 ||
      T_right_left.linear().determinant() < 0)
    throw InputError(file.string() + ": R", "is no rotation", "write the R of stereoCalibrate");
  cameras.T_left_right = T_right_left.inverse();
  return cameras;
}

void write_one(cv::FileStorage& storage, const CameraModel& camera, const std::string& matrix, const std::string& d) {
  const LensParameters& l = camera.lens;
  const auto c =
      camera.distortion == Distortion::equidistant ? coefficients(camera, {4}) : coefficients(camera, {4, 5, 8, 12});
  storage << matrix << cv::Mat(cv::Matx33d(l[0], 0, l[2], 0, l[1], l[3], 0, 0, 1));
  storage << d << cv::Mat(c, true).reshape(1, 1);
}

template <typename Matrix>
void write_matrix(cv::FileStorage& storage, const std::string& name, const Matrix& m) {
  cv::Mat out;
  cv::eigen2cv(m, out);
  storage << name << out;
}

}  // namespace

CalibratedCameras read_opencv(const fs::path& file) {
  const std::string text = read_file(file);
  try {
    const cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!storage.isOpened())
      throw InputError(file.string(), "is no OpenCV FileStorage", "give a .yml, .xml or .json that OpenCV wrote");
    return read_storage(storage, file);
  } catch (const cv::Exception& error) {
    throw InputError(file.string(), "is no OpenCV FileStorage (" + error.err + ")",
                     "give a .yml, .xml or .json that OpenCV wrote");
  }
}

std::vector<CameraFileText> opencv_text(const CalibratedCameras& cameras, const fs::path& file) {
  const std::string ending = file.extension() == ".xml" || file.extension() == ".json" ? file.extension() : ".yml";
  cv::FileStorage storage(ending, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "image_width" << cameras.left().width << "image_height" << cameras.left().height;
  if (cameras.left().distortion == Distortion::equidistant) storage << "fisheye_model" << 1;
  write_one(storage, cameras.left(), cameras.pair() ? "M1" : "camera_matrix",
            cameras.pair() ? "D1" : "distortion_coefficients");
  if (cameras.pair()) {
    write_one(storage, cameras.right(), "M2", "D2");
    const Pose T_right_left = cameras.T_left_right.inverse();
    cv::Matx33d R;
    for (int i = 0; i < 9; ++i) R.val[i] = T_right_left.linear()(i / 3, i % 3);
    const Eigen::Vector3d t = T_right_left.translation();
    storage << "R" << cv::Mat(R) << "T" << cv::Mat(cv::Matx31d(t.x(), t.y(), t.z()));
    const Rectification r = rectify(cameras);
    write_matrix(storage, "R1", r.R_left), write_matrix(storage, "R2", r.R_right);
    write_matrix(storage, "P1", r.P_left), write_matrix(storage, "P2", r.P_right);
    write_matrix(storage, "Q", r.Q);
  }
  return {{"", storage.releaseAndGetString()}};
}

}  // namespace foresight::formats
