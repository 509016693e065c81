// The sheet that a figure is drawn on: pictures in columns, each with its caption.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace foresight {

/// CV_8UC3.
struct FigurePanel {
  cv::Mat picture;
  std::string caption;  ///< ASCII; broken into lines of the picture's width
};

struct FigurePage {
  std::string title;  ///< one line or more of ASCII
  int columns = 1;
  std::vector<FigurePanel> panels;  ///< row by row
};

/// CV_8UC3, dark on white.
cv::Mat draw_page(const FigurePage& page);

/// A view (CV_8UC4, alpha as in PredictedView::picture()) as the thesis prints it: texels without
/// colour pink, what shows no model dark grey.
cv::Mat pink_holes(const cv::Mat& view);

/// `rect` of `picture` (CV_8UC3), each pixel `factor` x `factor`, without smoothing.
cv::Mat enlarged(const cv::Mat& picture, const cv::Rect& rect, int factor);

/// A copy with `rect` outlined: where a detail is from.
cv::Mat outlined(const cv::Mat& picture, const cv::Rect& rect);

}  // namespace foresight
