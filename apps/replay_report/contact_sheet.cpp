#include "apps/replay_report/contact_sheet.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "apps/replay_report/drawn_text.hpp"
#include "common/atomic_file.hpp"
#include "common/text.hpp"
#include "pictures/encode.hpp"

namespace foresight {
namespace {

const cv::Scalar kPaper{22, 19, 17}, kInk{238, 234, 232}, kFaint{160, 150, 144}, kGood{160, 214, 120};
constexpr int kHeading = 25, kCaption = 18;  // px, height of a line's capitals is about 0.7 of it

struct Layout {
  int width, margin, gap, tile_width, tile_height, top, row_height, bottom;

  Layout(int sheet_width, cv::Size picture) {
    width = std::max(640, sheet_width);
    margin = width / 48;
    gap = width / 160;
    tile_width = (width - 2 * margin - 3 * gap) / 4;
    tile_height = std::max(1, static_cast<int>(std::lround(1.0 * picture.height * tile_width / picture.width)));
    top = margin + 84;
    row_height = tile_height + kCaption + 32;
    bottom = 52;
  }
  int column(int i) const { return margin + i * (tile_width + gap); }
  int row(std::size_t i) const { return top + static_cast<int>(i) * row_height; }
};

void draw_tile(cv::Mat& sheet, const Layout& layout, const cv::Mat& picture, cv::Point at) {
  cv::Mat tile;
  const bool shrink = picture.cols >= layout.tile_width;
  cv::resize(picture, tile, {layout.tile_width, layout.tile_height}, 0, 0, shrink ? cv::INTER_AREA : cv::INTER_CUBIC);
  tile.copyTo(sheet(cv::Rect(at, tile.size())));
}

void draw_row(cv::Mat& sheet, const Layout& layout, const Instant& instant, int top) {
  const FrameRecord& f = instant.frame;
  const cv::Mat* pictures[] = {&instant.delayed, &instant.predicted, &instant.actual, &instant.error};
  const std::string shares =
      readable(100 * f.coverage.seen, 1, " % seen") + ", " + readable(100 * f.coverage.filled, 1, " % filled");
  const std::string captions[] = {
      readable(f.delayed.psnr_db, 1, " dB"), readable(f.predicted.psnr_db, 1, " dB"),
      "t = " + readable(f.time_s, 3, " s") + ", delayed by " + readable(1000 * f.delay_s, 0, " ms"), shares};
  const bool helps = f.predicted.psnr_db > f.delayed.psnr_db;
  for (int i = 0; i < 4; ++i) {
    draw_tile(sheet, layout, *pictures[i], {layout.column(i), top});
    const cv::Scalar colour = i > 1 ? kFaint : i == 1 && helps ? kGood : kInk;
    const int baseline = top + layout.tile_height + kCaption + 6;
    const DrawnText caption{captions[i], kCaption, colour, i < 2};
    draw_text(sheet, caption, {layout.column(i), baseline});
    if (i > 1) continue;
    const ImageQuality& q = i ? f.predicted : f.delayed;
    const std::string more = "SSIM " + readable(q.ssim, 2) + "   sharpness " + readable(q.sharpness, 2);
    draw_text(sheet, {more, kCaption - 2, kFaint}, {layout.column(i) + text_width(caption) + 16, baseline});
  }
}

void draw_headings(cv::Mat& sheet, const Layout& layout, const std::string& title) {
  draw_text(sheet, {title, kHeading + 5, kInk, true}, {layout.margin, layout.margin + 26});
  const char* headings[] = {"Delayed", "Predicted", "Actual", "Error"};
  for (int i = 0; i < 4; ++i)
    draw_text(sheet, {headings[i], kHeading - 3, kFaint}, {layout.column(i), layout.top - 12});
}

// What the colours of the error column mean, at its foot.
void draw_legend(cv::Mat& sheet, const Layout& layout, int top) {
  const int left = layout.column(3), height = 12, length = layout.tile_width / 3;
  const auto text = [&](const std::string& words, int x) {
    draw_text(sheet, {words, kCaption - 3, kFaint}, {x, top + height});
  };
  for (int x = 0; x < length; ++x)
    sheet(cv::Rect(left + x, top, 1, height)).setTo(cv::Scalar(error_colour(1.0 * x / length)));
  const std::string range = "0 to " + readable(kErrorRange, 0, " levels");
  text(range, left + length + 8);
  const int swatch = left + length + 8 + text_width({range, kCaption - 3, kFaint}) + 20;
  if (swatch + 90 > layout.width) return;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 2 * height; ++x)
      sheet.at<cv::Vec3b>(top + y, swatch + x) = (x + y) % 6 < 2 ? kFilledColour : kNoModelColour;
  text("filled", swatch + 2 * height + 8);
}

}  // namespace

cv::Mat draw_contact_sheet(const std::string& title, std::span<const Instant> instants, int width) {
  const Layout layout(width, instants.empty() ? cv::Size(4, 1) : instants.front().actual.size());
  const std::size_t rows = std::max<std::size_t>(1, instants.size());
  cv::Mat sheet(layout.row(rows) + layout.bottom, layout.width, CV_8UC3, kPaper);
  draw_headings(sheet, layout, title);
  for (std::size_t i = 0; i < instants.size(); ++i) draw_row(sheet, layout, instants[i], layout.row(i));
  if (instants.empty())
    draw_text(sheet, {"No image was replayed.", kCaption, kFaint}, {layout.margin, layout.top + 2 * kCaption});
  draw_legend(sheet, layout, layout.row(rows) + 8);
  return sheet;
}

void write_contact_sheet(const std::string& title, std::span<const Instant> instants,
                         const std::filesystem::path& file) {
  const std::vector<std::uint8_t> png = encode_png(draw_contact_sheet(title, instants));
  write_file_atomically(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace foresight
