#include "calibration/target/view_quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/statistics.hpp"

namespace foresight {
namespace {

/// Gradients across the images of the board's x and y axis, over the contrast.
double sharpness(const cv::Mat& grey, const std::vector<cv::Point2f>& hull, const cv::Matx33d& H,
                 const cv::Point2d& middle) {
  const cv::Rect box = cv::boundingRect(hull) & cv::Rect(1, 1, grey.cols - 2, grey.rows - 2);
  if (box.width < 3 || box.height < 3) return 0;
  cv::Mat inside = cv::Mat::zeros(box.size(), CV_8U);
  std::vector<cv::Point> polygon;
  for (const cv::Point2f& p : hull) polygon.emplace_back(cvRound(p.x) - box.x, cvRound(p.y) - box.y);
  cv::fillConvexPoly(inside, polygon, 255);
  const auto image_of = [&](const cv::Point2d& p) {
    const cv::Vec3d v = H * cv::Vec3d(p.x, p.y, 1);
    return cv::Point2d(v[0] / v[2], v[1] / v[2]);
  };
  std::vector<cv::Point2d> across;
  const double step = 1e-3 * (1 + cv::norm(middle));
  for (const cv::Point2d along : {cv::Point2d(0, step), {step, 0}}) {
    const cv::Point2d d = image_of(middle + along) - image_of(middle);
    across.push_back(cv::Point2d(-d.y, d.x) / cv::norm(d));
  }
  std::vector<float> values, slopes[2];
  const int stride = box.area() > 200000 ? 2 : 1;
  for (int y = 0; y < box.height; y += stride)
    for (int x = 0; x < box.width; x += stride) {
      if (!inside.at<uchar>(y, x)) continue;
      const uchar* row = grey.ptr<uchar>(box.y + y) + box.x + x;
      const double gx = (row[1] - row[-1]) / 2.0;
      const double gy = (*(row + grey.step) - *(row - grey.step)) / 2.0;
      values.push_back(*row);
      for (int axis = 0; axis < 2; ++axis)
        slopes[axis].push_back(static_cast<float>(std::abs(gx * across[axis].x + gy * across[axis].y)));
    }
  if (values.size() < 16) return 0;
  const double contrast = quantile(values, 0.95) - quantile(values, 0.05);
  const double slope = std::min(quantile(std::move(slopes[0]), 0.97), quantile(std::move(slopes[1]), 0.97));
  return contrast > 1 ? 2 * slope / contrast : 0;
}

/// The board's pose for a lens of 55 degrees; what matters is the order of views by it.
void set_tilt(const cv::Matx33d& H, cv::Size size, ViewQuality& quality) {
  const double f = std::max(size.width, size.height);
  const cv::Matx33d K_inverse(1 / f, 0, -size.width / (2 * f), 0, 1 / f, -size.height / (2 * f), 0, 0, 1);
  const cv::Matx33d M = K_inverse * H;
  Eigen::Vector3d x(M(0, 0), M(1, 0), M(2, 0)), y(M(0, 1), M(1, 1), M(2, 1));
  Eigen::Vector3d normal = x.cross(y).normalized();
  const Eigen::Vector3d sight = Eigen::Vector3d(M(0, 2), M(1, 2), M(2, 2)).normalized();
  if (normal.dot(sight) < 0) normal = -normal;
  quality.tilt_deg = std::acos(std::min(1.0, normal.dot(sight))) * 180 / CV_PI;
  // Along a step s in the image the plane's depth changes with -(n_x s_x + n_y s_y) / n_z.
  quality.turn_deg = std::atan2(-normal.y(), -normal.x()) * 180 / CV_PI;
}

}  // namespace

ViewQuality view_quality(const cv::Mat& grey, const std::vector<Corner>& corners,
                         const std::vector<Eigen::Vector3d>& p_board) {
  std::vector<cv::Point2f> board, image, hull;
  cv::Point2d middle;
  for (const Corner& corner : corners) {
    const Eigen::Vector3d& p = p_board[static_cast<std::size_t>(corner.index)];
    board.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    image.emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
    middle += cv::Point2d(p.x(), p.y()) / static_cast<double>(corners.size());
  }
  ViewQuality quality;
  cv::convexHull(image, hull);
  quality.coverage = cv::contourArea(hull) / static_cast<double>(grey.total());
  const cv::Mat found = cv::findHomography(board, image);
  if (found.empty()) return quality;
  const cv::Matx33d H(found);
  // The origin into the middle: what the tilt is measured against.
  const cv::Matx33d from_middle(1, 0, middle.x, 0, 1, middle.y, 0, 0, 1);
  quality.sharpness = sharpness(grey, hull, H, middle);
  set_tilt(H * from_middle, grey.size(), quality);
  return quality;
}

}  // namespace foresight
