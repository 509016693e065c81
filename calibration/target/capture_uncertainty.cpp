#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

#include "calibration/target/capture_guide.hpp"

namespace foresight {
namespace {

double usual_focal_length(cv::Size size) {
  return std::max(size.width, size.height);
}

/// Derivatives of the pixel of a direction (x, y, 1) by fx fy cx cy k1 k2, where k1 = k2 = 0.
Eigen::Matrix<double, 2, 6> lens_jacobian(double f, double x, double y) {
  const double r2 = x * x + y * y;
  Eigen::Matrix<double, 2, 6> J;
  J << x, 0, 1, 0, f * x * r2, f * x * r2 * r2, 0, y, 0, 1, f * y * r2, f * y * r2 * r2;
  return J;
}

/// By a small rotation of the direction.
Eigen::Matrix<double, 2, 3> rotation_jacobian(double f, double x, double y) {
  Eigen::Matrix<double, 2, 3> R;
  R << -f * x * y, f * (1 + x * x), -f * y, -f * (1 + y * y), f * x * y, f * x;
  return R;
}

}  // namespace

Eigen::Matrix<double, 6, 6> lens_information(const std::vector<Corner>& corners,
                                             const std::vector<Eigen::Vector3d>& p_board, cv::Size size) {
  const double f = usual_focal_length(size);
  const cv::Matx33d K(f, 0, (size.width - 1) / 2.0, 0, f, (size.height - 1) / 2.0, 0, 0, 1);
  std::vector<cv::Point3d> board;
  std::vector<cv::Point2d> image;
  for (const Corner& corner : corners) {
    const Eigen::Vector3d& p = p_board[static_cast<std::size_t>(corner.index)];
    board.emplace_back(p.x(), p.y(), p.z());
    image.emplace_back(corner.pixel.x(), corner.pixel.y());
  }
  cv::Vec3d rotation, translation;
  using Information = Eigen::Matrix<double, 6, 6>;
  if (!cv::solvePnP(board, image, K, cv::noArray(), rotation, translation, false, cv::SOLVEPNP_IPPE))
    return Information::Zero();
  cv::Matx33d R;
  cv::Rodrigues(rotation, R);
  Information lens = Information::Zero(), both = Information::Zero(), pose = Information::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Vec3d p = R * cv::Vec3d(board[i].x, board[i].y, board[i].z) + translation;
    if (!(p[2] > 0)) return Information::Zero();
    const double x = p[0] / p[2], y = p[1] / p[2], weight = 1 / (corners[i].sigma_px * corners[i].sigma_px);
    Eigen::Matrix<double, 2, 6> by_pose;
    Eigen::Matrix<double, 2, 3> by_translation;
    by_translation << f / p[2], 0, -f * x / p[2], 0, f / p[2], -f * y / p[2];
    by_pose << rotation_jacobian(f, x, y), by_translation;
    const Eigen::Matrix<double, 2, 6> by_lens = lens_jacobian(f, x, y);
    lens += weight * by_lens.transpose() * by_lens;
    both += weight * by_lens.transpose() * by_pose;
    pose += weight * by_pose.transpose() * by_pose;
  }
  return lens - both * pose.ldlt().solve(both.transpose());
}

cv::Mat CaptureGuide::uncertainty(int columns, int rows) const {
  if (views() < 3) return {};
  const double f = usual_focal_length(size_);
  std::vector<Eigen::Matrix<double, 2, 6>> lens;
  std::vector<Eigen::Matrix<double, 2, 3>> turns;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> mixed = Eigen::Matrix<double, 3, 6>::Zero();
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double x = ((column + 0.5) / columns - 0.5) * size_.width / f;
      const double y = ((row + 0.5) / rows - 0.5) * size_.height / f;
      lens.push_back(lens_jacobian(f, x, y));
      turns.push_back(rotation_jacobian(f, x, y));
      normal += turns.back().transpose() * turns.back();
      mixed += turns.back().transpose() * lens.back();
    }
  const Eigen::Matrix<double, 3, 6> taken_up = normal.inverse() * mixed;
  const Eigen::Matrix<double, 6, 6> covariance = information_.inverse();
  cv::Mat map(rows, columns, CV_64F);
  for (int i = 0; i < rows * columns; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Eigen::Matrix<double, 2, 6> J = lens[at] - turns[at] * taken_up;
    map.at<double>(i / columns, i % columns) = std::sqrt((J * covariance * J.transpose()).trace() / 2);
  }
  return map;
}

}  // namespace foresight
