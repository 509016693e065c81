// Lines of text in pictures.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace foresight {

struct DrawnText {
  std::string text;  ///< ASCII
  int size;          ///< px; capitals are about 0.7 of it
  cv::Scalar colour;
  bool bold = false;
};

int text_width(const DrawnText& text);  ///< px

/// `sheet`: CV_8UC3. `at`: left end of the baseline. Clipped to the sheet.
void draw_text(cv::Mat& sheet, const DrawnText& text, cv::Point at);

}  // namespace foresight
