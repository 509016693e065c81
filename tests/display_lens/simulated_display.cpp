#include "tests/display_lens/simulated_display.hpp"

#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

bool seen(const SimulatedDisplay& display, const Eigen::Vector3d& direction) {
  const Lens eye = to_lens(display.eye);
  for (const Pose& T : display.T_display_camera) {
    const auto pixel = eye.project(T.linear().transpose() * direction);
    if (pixel && pixel->x() > 20 && pixel->y() > 20 && pixel->x() < 1260 && pixel->y() < 1004) return true;
  }
  return false;
}

}  // namespace

cv::Mat picture_of(const SimulatedDisplay& display, const cv::Mat& panel, std::size_t picture) {
  const Lens lens = to_lens(display.panel), eye = to_lens(display.eye);
  cv::Mat soft;
  cv::GaussianBlur(panel, soft, {7, 7}, 1.2);  // a camera pixel covers more than one of the panel's
  cv::Mat map(display.eye.height, display.eye.width, CV_32FC2), out;
  for (int v = 0; v < map.rows; ++v)
    for (int u = 0; u < map.cols; ++u) {
      const auto ray = eye.unproject({u, v});
      const auto pixel = ray ? lens.project(display.T_display_camera[picture].linear() * *ray) : std::nullopt;
      map.at<cv::Vec2f>(v, u) =
          pixel ? cv::Vec2f(static_cast<float>(pixel->x()), static_cast<float>(pixel->y())) : cv::Vec2f(-100, -100);
    }
  cv::remap(soft, out, map, {}, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(30));
  cv::GaussianBlur(out, out, {5, 5}, 0.8);
  return out;
}

double worst_unseen(const SimulatedDisplay& display, const CameraModel& found, const Eigen::Matrix3d& R_found_true,
                    const PanelArea& area) {
  const Lens truth = to_lens(display.panel);
  double worst = 0;
  int count = 0;
  for (double u = area.left; u < area.right; u += 23)
    for (double v = area.top; v < area.bottom; v += 29) {
      const auto direction = truth.unproject({u, v});
      if (!direction || !seen(display, *direction)) continue;
      Eigen::Vector2d pixel;
      if (!project<double>(found.distortion, found.lens.data(), R_found_true * *direction, pixel)) return INFINITY;
      worst = std::max(worst, (pixel - Eigen::Vector2d(u, v)).norm());
      ++count;
    }
  return count > 500 ? worst : INFINITY;
}

}  // namespace foresight
