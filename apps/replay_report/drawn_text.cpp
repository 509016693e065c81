#include "apps/replay_report/drawn_text.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

constexpr int kOversampling = 4;  // OpenCV draws bare strokes: drawn large and scaled down they look like type

cv::Size drawn_size(const DrawnText& t, double& scale, int& thickness, int& baseline) {
  scale = t.size * kOversampling / 30.0;
  thickness = std::max(1, static_cast<int>(std::lround(t.size * kOversampling * (t.bold ? 0.085 : 0.06))));
  return cv::getTextSize(t.text, cv::FONT_HERSHEY_SIMPLEX, scale, thickness, &baseline);
}

}  // namespace

int text_width(const DrawnText& t) {
  double scale;
  int thickness, baseline;
  return drawn_size(t, scale, thickness, baseline).width / kOversampling;
}

void draw_text(cv::Mat& sheet, const DrawnText& t, cv::Point at) {
  double scale;
  int thickness, baseline;
  const cv::Size size = drawn_size(t, scale, thickness, baseline);
  const int pad = t.size / 2;
  cv::Rect box(at.x - pad, at.y - t.size - pad, size.width / kOversampling + 2 * pad, 2 * t.size + 2 * pad);
  cv::Mat large = cv::Mat::zeros(box.height * kOversampling, box.width * kOversampling, CV_8U), ink;
  cv::putText(large, t.text, cv::Point(pad, t.size + pad) * kOversampling, cv::FONT_HERSHEY_SIMPLEX, scale, 255,
              thickness, cv::LINE_AA);
  cv::resize(large, ink, box.size(), 0, 0, cv::INTER_AREA);
  const cv::Rect inside = box & cv::Rect(0, 0, sheet.cols, sheet.rows);
  for (int y = inside.y; y < inside.br().y; ++y)
    for (int x = inside.x; x < inside.br().x; ++x) {
      const double share = ink.at<uchar>(y - box.y, x - box.x) / 255.0;
      auto& pixel = sheet.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) pixel[c] = cv::saturate_cast<uchar>(std::lerp(pixel[c], t.colour[c], share));
    }
}

}  // namespace foresight
