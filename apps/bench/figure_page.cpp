#include "apps/bench/figure_page.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "apps/replay_report/drawn_text.hpp"
#include "pictures/view_alpha.hpp"

namespace foresight {
namespace {

const cv::Scalar kPaper{255, 255, 255}, kInk{32, 28, 26};
const cv::Vec3b kPink{180, 105, 255}, kNoModel{64, 64, 64};
const cv::Scalar kOutline{0, 220, 255};
constexpr int kMargin = 20, kGap = 12;  // px
constexpr int kNarrowest = 260;         // px; narrower columns could not hold a caption

std::vector<std::string> broken(const std::string& text, int size, bool bold, int width) {
  std::vector<std::string> lines{""};
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || text_width({longer, size, kInk, bold}) <= width)
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  return lines;
}

int line_height(int size) {
  return size * 3 / 2;
}

void draw_lines(cv::Mat& sheet, const std::vector<std::string>& lines, int size, bool bold, cv::Point top_left) {
  for (std::size_t i = 0; i < lines.size(); ++i)
    draw_text(sheet, {lines[i], size, kInk, bold},
              {top_left.x, top_left.y + size + static_cast<int>(i) * line_height(size)});
}

struct Grid {
  std::vector<int> lefts, widths, tops, heights;  // of columns and rows, pictures only
  int width = 0, height = 0, title_size = 0, caption_size = 0;
  std::vector<std::string> title;
  std::vector<std::vector<std::string>> captions;

  explicit Grid(const FigurePage& page) {
    const auto columns = static_cast<std::size_t>(page.columns);
    const std::size_t rows = (page.panels.size() + columns - 1) / columns;
    widths.assign(columns, kNarrowest);
    for (std::size_t i = 0; i < page.panels.size(); ++i)
      widths[i % columns] = std::max(widths[i % columns], page.panels[i].picture.cols);
    width = kMargin;
    for (const int w : widths) {
      lefts.push_back(width);
      width += w + kGap;
    }
    width += kMargin - kGap;
    caption_size = std::clamp(width / 80, 16, 30);  // pages are shown scaled to a column of text
    title_size = caption_size * 9 / 8;
    title = broken(page.title, title_size, true, width - 2 * kMargin);
    height = kMargin + static_cast<int>(title.size()) * line_height(title_size);
    for (std::size_t row = 0; row < rows; ++row) {
      tops.push_back(height);
      std::size_t lines = 0;
      int tallest = 0;
      for (std::size_t i = row * columns; i < std::min((row + 1) * columns, page.panels.size()); ++i) {
        captions.push_back(broken(page.panels[i].caption, caption_size, false, widths[i % columns]));
        lines = std::max(lines, captions.back().size());
        tallest = std::max(tallest, page.panels[i].picture.rows);
      }
      heights.push_back(tallest);
      height += tallest + kGap / 2 + static_cast<int>(lines) * line_height(caption_size) + kGap;
    }
  }
};

}  // namespace

cv::Mat draw_page(const FigurePage& page) {
  const Grid grid(page);
  cv::Mat sheet(grid.height, grid.width, CV_8UC3, kPaper);
  draw_lines(sheet, grid.title, grid.title_size, true, {kMargin, kMargin / 2});
  for (std::size_t i = 0; i < page.panels.size(); ++i) {
    const cv::Mat& picture = page.panels[i].picture;
    const std::size_t column = i % grid.lefts.size(), row = i / grid.lefts.size();
    const cv::Point at(grid.lefts[column], grid.tops[row]);
    picture.copyTo(sheet(cv::Rect(at, picture.size())));
    draw_lines(sheet, grid.captions[i], grid.caption_size, false, {at.x, at.y + grid.heights[row] + kGap / 2});
  }
  return sheet;
}

cv::Mat pink_holes(const cv::Mat& view) {
  cv::Mat out(view.size(), CV_8UC3);
  for (int y = 0; y < view.rows; ++y)
    for (int x = 0; x < view.cols; ++x) {
      const auto& pixel = view.at<cv::Vec4b>(y, x);
      out.at<cv::Vec3b>(y, x) = pixel[3] == view_alpha::kNoModel   ? kNoModel
                                : pixel[3] < view_alpha::kFromFill ? kPink
                                                                   : cv::Vec3b(pixel[0], pixel[1], pixel[2]);
    }
  return out;
}

cv::Mat enlarged(const cv::Mat& picture, const cv::Rect& rect, int factor) {
  cv::Mat out;
  cv::resize(picture(rect), out, {}, factor, factor, cv::INTER_NEAREST);
  return out;
}

cv::Mat outlined(const cv::Mat& picture, const cv::Rect& rect) {
  cv::Mat out = picture.clone();
  cv::rectangle(out, rect, kOutline, std::max(1, picture.cols / 320));
  return out;
}

}  // namespace foresight
