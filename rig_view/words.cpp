#include "rig_view/words.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kSize = 0.44;
constexpr double kSmallest = 0.75;  // of a text's size: what is smaller nobody reads
constexpr int kGap = 3;             // px between words
const cv::Scalar kHalo(246, 245, 244);

struct Place {
  cv::Point2i anchor;
  cv::Rect box;
};

/// Around the anchor, ever farther, until nothing is covered.
cv::Rect free_box(cv::Point anchor, cv::Size size, const std::vector<Place>& taken, const cv::Size& picture) {
  const cv::Rect whole({0, 0}, picture);
  for (int ring = 0; ring < 14; ++ring) {
    const int dy = ring * (size.height + kGap);
    const cv::Point beside[] = {{9, -dy - size.height / 2},
                                {9, dy - size.height / 2},
                                {-9 - size.width, -dy - size.height / 2},
                                {-9 - size.width, dy - size.height / 2}};
    for (const cv::Point& offset : beside) {
      const cv::Rect box(anchor + offset, size);
      const cv::Rect wide(box.x - kGap, box.y - 1, box.width + 2 * kGap, box.height + 2);
      if ((box & whole) == box &&
          std::ranges::none_of(taken, [&](const Place& other) { return (other.box & wide).area() > 0; }))
        return box;
    }
  }
  return {anchor + cv::Point(9, -size.height / 2), size};
}

}  // namespace

std::string fitting_text(const std::string& text, double size, int width_px, int weight) {
  std::string out;
  for (const char c : text)  // the font has one '?' for each byte that it does not know
    if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) out += c;
  const std::string whole = out;
  const auto too_wide = [&] { return cv::getTextSize(out, kFont, size, weight, nullptr).width > width_px; };
  for (std::size_t kept = whole.size(); kept > 2 && width_px > 0 && too_wide(); --kept)
    out = whole.substr(0, kept / 2) + ".." + whole.substr(whole.size() - (kept - kept / 2));
  return out;
}

void put_text(cv::Mat& picture, const std::string& text, cv::Point at, double size, const cv::Scalar& colour,
              int width_px, int weight) {
  const std::string shown = fitting_text(text, kSmallest * size, width_px, weight);
  const int wanted = cv::getTextSize(shown, kFont, size, weight, nullptr).width;
  const double fitting = width_px > 0 && wanted > width_px ? size * width_px / wanted : size;
  cv::putText(picture, shown, at, kFont, fitting, colour, weight, cv::LINE_AA);
}

std::size_t write_words(cv::Mat& picture, const std::vector<Drawing::Word>& words, const Eye& eye) {
  std::vector<Place> taken;
  for (const Drawing::Word& word : words) {
    const auto pixel = eye.pixel(word.at, picture.cols, picture.rows);
    if (!pixel) continue;
    const cv::Point anchor(cvRound(pixel->x()), cvRound(pixel->y()));
    if (!cv::Rect({0, 0}, picture.size()).contains(anchor)) continue;
    int below = 0;
    cv::Size size = cv::getTextSize(word.text, kFont, kSize, 1, &below);
    size.height += below;
    const cv::Rect box = free_box(anchor, size, taken, picture.size());
    taken.push_back({anchor, box});
    const cv::Point start(std::clamp(anchor.x, box.x, box.x + box.width), box.y + box.height / 2);
    cv::line(picture, anchor, start, bgr(word.colour) * 0.6 + kHalo * 0.4, 1, cv::LINE_AA);
    const cv::Point baseline(box.x, box.y + box.height - below);
    cv::putText(picture, word.text, baseline, kFont, kSize, kHalo, 3, cv::LINE_AA);
    cv::putText(picture, word.text, baseline, kFont, kSize, bgr(word.colour), 1, cv::LINE_AA);
  }
  return taken.size();
}

}  // namespace foresight
