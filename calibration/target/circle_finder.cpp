#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/target/board_finders.hpp"
#include "calibration/target/grid_order.hpp"
#include "calibration/target/refine_corners.hpp"

namespace foresight {
namespace {

GridPoints rough_centres(const cv::Mat& grey, cv::Size size) {
  cv::SimpleBlobDetector::Params blobs;
  blobs.maxArea = static_cast<float>(grey.total()) / static_cast<float>(size.area());
  blobs.minDistBetweenBlobs = 5;
  for (const uchar colour : {uchar{0}, uchar{255}}) {
    blobs.blobColor = colour;
    const auto detector = cv::SimpleBlobDetector::create(blobs);
    for (const int flags : {int{cv::CALIB_CB_SYMMETRIC_GRID}, cv::CALIB_CB_SYMMETRIC_GRID | cv::CALIB_CB_CLUSTERING}) {
      GridPoints points;
      if (cv::findCirclesGrid(grey, size, points, flags, detector)) return points;
    }
  }
  return {};
}

/// Area of the disc around `centre`, px^2: the pixels nearer in brightness to its middle than to what surrounds it.
double disc_area(const cv::Mat& grey, cv::Point2f centre, float spacing) {
  const int half = std::max(2, static_cast<int>(0.45f * spacing));
  cv::Mat patch;
  cv::getRectSubPix(grey, {2 * half + 1, 2 * half + 1}, centre, patch, CV_32F);
  const double inside = patch.at<float>(half, half);
  const double outside = (patch.at<float>(0, 0) + patch.at<float>(0, 2 * half) + patch.at<float>(2 * half, 0) +
                          patch.at<float>(2 * half, 2 * half)) /
                         4;
  const cv::Mat dark =
      inside < outside ? cv::Mat(patch < (inside + outside) / 2) : cv::Mat(patch > (inside + outside) / 2);
  return cv::countNonZero(dark);
}

/// Index of the one disc that is much bigger than the others, -1 where there is none.
int big_disc(const std::vector<double>& areas) {
  std::vector<double> sorted = areas;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  const double next = sorted[sorted.size() - 2];
  // Perspective alone makes neighbours in size, not a single one that stands out.
  if (sorted.back() < 1.8 * usual || sorted.back() < 1.4 * next) return -1;
  return static_cast<int>(std::max_element(areas.begin(), areas.end()) - areas.begin());
}

/// From the middle of a disc's image, an ellipse, to the image of its centre: the dual conic of the
/// circle goes through the homography of the grid (Hartley and Zisserman, 8.2 and 2.11).
std::vector<cv::Point2f> true_centres(const GridPoints& middles, const std::vector<double>& areas, int cols) {
  std::vector<cv::Point2f> grid;
  for (std::size_t i = 0; i < middles.size(); ++i)
    grid.emplace_back(static_cast<float>(i % static_cast<std::size_t>(cols)),
                      static_cast<float>(i / static_cast<std::size_t>(cols)));
  const cv::Mat found = cv::findHomography(grid, middles);
  if (found.empty()) return middles;
  const cv::Matx33d H(found);
  std::vector<cv::Point2f> centres;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const double x = grid[i].x, y = grid[i].y;
    const cv::Vec3d p = H * cv::Vec3d(x, y, 1);
    const double area_scale = std::abs(cv::determinant(H)) / std::abs(p[2] * p[2] * p[2]);
    const double r2 = areas[i] / CV_PI / area_scale;
    const cv::Matx33d dual = H * cv::Matx33d(r2 - x * x, -x * y, -x, -x * y, r2 - y * y, -y, -x, -y, -1) * H.t();
    const cv::Point2d middle(dual(0, 2) / dual(2, 2), dual(1, 2) / dual(2, 2)), centre(p[0] / p[2], p[1] / p[2]);
    const cv::Point2d shift = centre - middle;
    centres.push_back(middles[i] + cv::Point2f(static_cast<float>(shift.x), static_cast<float>(shift.y)));
  }
  return centres;
}

}  // namespace

FoundPoints find_circles(const cv::Mat& grey, const Board& board) {
  const GridPoints rough = rough_centres(grey, {board.cols, board.rows});
  if (rough.empty()) return {};
  const auto orders = grid_orders(rough, board.cols, board.rows);
  int first = static_cast<int>(rough.size());
  const GridPoints* chosen = &orders.front();
  std::vector<double> areas;
  for (const GridPoints& order : orders) {
    const auto spacing = neighbour_spacing(order, board.cols, board.rows);
    std::vector<double> of_order(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) of_order[i] = disc_area(grey, order[i], spacing[i]);
    const int big = big_disc(of_order);
    if (areas.empty()) areas = of_order;
    if (big < 0 || big >= first) continue;
    first = big;
    chosen = &order;
    areas = of_order;
  }
  FoundPoints found;
  found.ambiguous = first == static_cast<int>(rough.size());
  const double noise = pixel_noise(grey);
  const auto centres = true_centres(*chosen, areas, board.cols);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const cv::Point2f p = centres[i];
    found.corners.push_back({static_cast<int>(i), {p.x, p.y}, disc_noise(grey, p, std::sqrt(areas[i] / CV_PI), noise)});
  }
  return found;
}

}  // namespace foresight
