#include "calibration/target/capture_picture.hpp"

#include <opencv2/imgproc.hpp>

#include "common/atomic_file.hpp"
#include "common/counted.hpp"
#include "common/text.hpp"
#include "pictures/encode.hpp"

namespace foresight {
namespace {

const cv::Scalar kGreen(80, 220, 80), kAmber(40, 180, 255), kWhite(245, 245, 245), kGrey(150, 145, 140),
    kDark(48, 42, 38), kBar(80, 72, 66);
const cv::Rect kImage(12, 132, 916, 656), kPanel(944, 132, 324, 656);
constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;

/// As large as `largest`, or as fits into `width`.
void write(cv::Mat& canvas, const std::string& text, cv::Point at, double largest, int width, const cv::Scalar& colour,
           int weight = 1) {
  const int wanted = cv::getTextSize(text, kFont, largest, weight, nullptr).width;
  const double size = wanted > width ? largest * width / wanted : largest;
  cv::putText(canvas, text, at, kFont, size, colour, weight, cv::LINE_AA);
}

cv::Mat in_colours(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat out;
  cv::cvtColor(image, out, cv::COLOR_GRAY2BGR);
  return out;
}

/// Where an image lies on the canvas.
struct Placed {
  Placed(const cv::Mat& image, const cv::Rect& within)
      : scale(
            std::min(within.width / static_cast<double>(image.cols), within.height / static_cast<double>(image.rows))),
        rect(0, 0, cvRound(image.cols * scale), cvRound(image.rows * scale)) {
    rect.x = within.x + (within.width - rect.width) / 2;
    rect.y = within.y;
  }
  cv::Point at(const Eigen::Vector2d& pixel) const {
    return {rect.x + cvRound((pixel.x() + 0.5) * scale), rect.y + cvRound((pixel.y() + 0.5) * scale)};
  }
  cv::Rect part(cv::Point cell, cv::Size raster) const {
    const int x0 = rect.width * cell.x / raster.width, x1 = rect.width * (cell.x + 1) / raster.width;
    const int y0 = rect.height * cell.y / raster.height, y1 = rect.height * (cell.y + 1) / raster.height;
    return {rect.x + x0, rect.y + y0, x1 - x0, y1 - y0};
  }
  double scale;
  cv::Rect rect;
};

Placed put(cv::Mat& canvas, const cv::Mat& image, const cv::Rect& within) {
  const Placed placed(image, within);
  cv::resize(in_colours(image), canvas(placed.rect), placed.rect.size(), 0, 0, cv::INTER_AREA);
  return placed;
}

void tint(cv::Mat& canvas, const cv::Rect& part, const cv::Scalar& colour, double strength) {
  cv::Mat region = canvas(part);
  cv::addWeighted(region, 1 - strength, cv::Mat(region.size(), CV_8UC3, colour), strength, 0, region);
}

void polygon(cv::Mat& canvas, const std::vector<cv::Point>& points, const cv::Scalar& colour, int width) {
  cv::polylines(canvas, points, true, colour, width, cv::LINE_AA);
}

/// A board as it looks when its `side` lies farther away.
std::vector<cv::Point> tilted_board(const cv::Rect& image, int side) {
  const double w = 0.24 * image.width, h = 0.26 * image.height, squeeze = 0.55;
  std::vector<cv::Point> out;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const bool far = side == 0 ? x > 0 : side == 1 ? y > 0 : side == 2 ? x < 0 : y < 0;
    const double dx = side % 2 == 0 ? 0.7 : far ? squeeze : 1, dy = side % 2 == 1 ? 0.7 : far ? squeeze : 1;
    out.emplace_back(image.x + image.width / 2 + cvRound(x * w * dx), image.y + image.height / 2 + cvRound(y * h * dy));
  }
  return out;
}

void draw_wish(cv::Mat& canvas, const Placed& placed, const CaptureProgress& progress) {
  const CaptureWish& wish = progress.wish;
  const cv::Rect& image = placed.rect;
  const cv::Point middle(image.x + image.width / 2, image.y + image.height / 2);
  const auto centred = [&](double share) {
    const int w = cvRound(share * image.width), h = cvRound(share * image.height);
    return cv::Rect(middle.x - w / 2, middle.y - h / 2, w, h);
  };
  switch (wish.kind) {
    case CaptureWish::Kind::first: cv::rectangle(canvas, centred(0.5), kAmber, 5, cv::LINE_AA); break;
    case CaptureWish::Kind::tilt: {
      polygon(canvas, tilted_board(image, wish.side), kAmber, 6);
      constexpr std::array<std::array<int, 2>, 4> kTowards{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
      const auto [dx, dy] = kTowards[static_cast<std::size_t>(wish.side)];
      const int reach = image.height / 3;
      cv::arrowedLine(canvas, middle, {middle.x + dx * reach, middle.y + dy * reach}, kAmber, 10, cv::LINE_AA, 0, 0.3);
      break;
    }
    case CaptureWish::Kind::place: {
      const cv::Rect part = placed.part(wish.cell, progress.seen.size());
      tint(canvas, part, kAmber, 0.45);
      cv::rectangle(canvas, part, kAmber, 8);
      const cv::Point to(part.x + part.width / 2, part.y + part.height / 2);
      if (cv::norm(to - middle) > 40) cv::arrowedLine(canvas, middle, to, kAmber, 10, cv::LINE_AA, 0, 0.25);
      break;
    }
    case CaptureWish::Kind::size:
      for (const double share : {0.28, 0.8}) cv::rectangle(canvas, centred(share), kAmber, 5, cv::LINE_AA);
      break;
    case CaptureWish::Kind::none: break;
  }
}

void draw_image(cv::Mat& canvas, const CaptureMoment& moment) {
  const CaptureProgress& progress = moment.progress;
  const Placed placed = put(canvas, moment.left, kImage);
  for (int row = 0; row < progress.seen.rows; ++row)
    for (int column = 0; column < progress.seen.cols; ++column)
      if (progress.seen.at<uchar>(row, column) == 0 && progress.views > 0) {
        const cv::Rect part = placed.part({column, row}, progress.seen.size());
        tint(canvas, part, kAmber, 0.2);
        cv::rectangle(canvas, part, kAmber, 1);
      }
  for (const auto& outline : progress.outlines) {
    std::vector<cv::Point> points;
    for (const Eigen::Vector2d& p : outline) points.push_back(placed.at(p));
    polygon(canvas, points, kGreen, 2);
  }
  if (!progress.enough) draw_wish(canvas, placed, progress);
  const cv::Scalar& colour = moment.outcome.verdict.taken ? kGreen : kAmber;
  if (const auto& found = moment.outcome.found[0])
    for (const Corner& corner : found->corners) {
      cv::circle(canvas, placed.at(corner.pixel), 6, cv::Scalar::all(0), cv::FILLED, cv::LINE_AA);
      cv::circle(canvas, placed.at(corner.pixel), 4, colour, cv::FILLED, cv::LINE_AA);
    }
  if (moment.outcome.verdict.taken) cv::rectangle(canvas, placed.rect, kGreen, 12);
}

struct Bar {
  std::string name, value;
  double share = 0, mark = -1;  // of the bar's length; mark: a limit, none below 0
  bool good = false;
};

std::vector<Bar> bars_of(const CaptureMoment& moment) {
  const CaptureProgress& p = moment.progress;
  const auto sides = static_cast<int>(std::count(p.tilted.begin(), p.tilted.end(), true));
  std::vector<Bar> bars{
      {"views", std::to_string(p.views) + " of " + std::to_string(p.views_wanted),
       static_cast<double>(p.views) / p.views_wanted, -1, p.views >= p.views_wanted},
      {"coverage", readable(100 * p.coverage(), 0) + " %", p.coverage(), -1, p.coverage() >= 1},
      {"tilted to", std::to_string(sides) + " of 4 sides", sides / 4.0, -1, sides == 4},
      {"near : far", readable(p.size_ratio, 1) + " of " + readable(p.size_ratio_wanted, 1),
       (p.size_ratio - 1) / (p.size_ratio_wanted - 1), -1, p.size_ratio >= p.size_ratio_wanted},
  };
  const auto& found = moment.outcome.found[0];
  const double sharpness = found ? found->quality.sharpness : 0, best = std::max({p.sharpest, sharpness, 1e-9});
  bars.push_back({"sharpness", found ? readable(sharpness, 2) : "-", sharpness / best, p.sharp_enough / best,
                  found && sharpness >= p.sharp_enough});
  bars.push_back({"tilt now", found ? readable(found->quality.tilt_deg, 0) + " deg" : "-",
                  found ? found->quality.tilt_deg / 60 : 0, -1, found.has_value()});
  return bars;
}

void draw_bar(cv::Mat& canvas, const Bar& bar, int y) {
  const cv::Scalar& colour = bar.good ? kGreen : kAmber;
  write(canvas, bar.name, {kPanel.x, y + 24}, 0.85, 150, kWhite);
  write(canvas, bar.value, {kPanel.x + 164, y + 24}, 0.85, kPanel.width - 164, colour);
  const cv::Rect whole(kPanel.x, y + 33, kPanel.width, 16);
  cv::rectangle(canvas, whole, kBar, cv::FILLED);
  const int length = cvRound(std::clamp(bar.share, 0.0, 1.0) * whole.width);
  if (length > 0) cv::rectangle(canvas, {whole.x, whole.y, length, whole.height}, colour, cv::FILLED);
  if (bar.mark < 0) return;
  const int at = whole.x + cvRound(bar.mark * whole.width);
  cv::line(canvas, {at, whole.y - 4}, {at, whole.y + whole.height + 4}, kWhite, 3);
}

/// Bright where the lens is still unknown.
void draw_map(cv::Mat& canvas, const CaptureMoment& moment, const cv::Rect& within) {
  const cv::Mat& map = moment.progress.uncertainty;
  if (map.empty()) {
    write(canvas, "uncertainty: from 3 views on", {within.x, within.y + 24}, 0.7, within.width, kGrey);
    return;
  }
  cv::Mat scaled, colours;
  double least = 0, most = 0;
  cv::minMaxLoc(map, &least, &most);
  cv::Mat(map / most * 255).convertTo(scaled, CV_8U);
  cv::applyColorMap(scaled, colours, cv::COLORMAP_VIRIDIS);
  const double ratio = moment.left.cols / static_cast<double>(moment.left.rows);
  cv::resize(colours, colours, {cvRound(within.height * ratio), within.height}, 0, 0, cv::INTER_LINEAR);
  if (colours.cols > within.width / 2) cv::resize(colours, colours, {within.width / 2, within.height});
  colours.copyTo(canvas(cv::Rect(within.x, within.y, colours.cols, colours.rows)));
  const int x = within.x + colours.cols + 10, width = within.width - colours.cols - 10;
  write(canvas, "uncertainty", {x, within.y + 24}, 0.75, width, kWhite);
  write(canvas, readable(least, 2) + " to", {x, within.y + 54}, 0.75, width, kWhite);
  write(canvas, readable(most, 2) + " px", {x, within.y + 84}, 0.75, width, kWhite);
}

void draw_panel(cv::Mat& canvas, const CaptureMoment& moment) {
  int y = kPanel.y;
  for (const Bar& bar : bars_of(moment)) draw_bar(canvas, bar, y), y += 57;
  if (!moment.right.empty()) {
    const Placed placed = put(canvas, moment.right, {kPanel.x, y + 8, kPanel.width, 190});
    const auto& found = moment.outcome.found[1];
    if (found)
      for (const Corner& corner : found->corners)
        cv::circle(canvas, placed.at(corner.pixel), 2, kGreen, cv::FILLED, cv::LINE_AA);
    cv::rectangle(canvas, placed.rect, found ? kGreen : kAmber, 4);
    write(canvas, found ? "right" : "right: no board", {placed.rect.x + 8, placed.rect.y + 26}, 0.8,
          placed.rect.width - 16, found ? kGreen : kAmber);
  }
  draw_map(canvas, moment, {kPanel.x, kPanel.y + kPanel.height - 106, kPanel.width, 106});
}

std::string headline(const CaptureProgress& progress) {
  if (progress.enough) return "ENOUGH: " + counted(progress.views, "view");
  switch (progress.wish.kind) {
    case CaptureWish::Kind::first: return "SHOW THE BOARD";
    case CaptureWish::Kind::tilt: return "TILT IT: " + progress.wish.where + " side away";
    case CaptureWish::Kind::place: return "MOVE IT: " + progress.wish.where;
    case CaptureWish::Kind::size: return "NEARER, OR FARTHER AWAY";
    case CaptureWish::Kind::none: break;
  }
  return "ANOTHER VIEW: turned or moved";
}

}  // namespace

cv::Mat capture_picture(const CaptureMoment& moment) {
  cv::Mat canvas(kCapturePictureHeight, kCapturePictureWidth, CV_8UC3, kDark);
  const bool taken = moment.outcome.verdict.taken;
  const std::string& reason = moment.outcome.verdict.reason;
  const int width = kCapturePictureWidth - 32;
  write(canvas, headline(moment.progress), {16, 62}, 2.0, width, moment.progress.enough ? kGreen : kWhite, 3);
  write(canvas, taken ? "taken: view " + std::to_string(moment.progress.views) : reason, {16, 114}, 1.4, width,
        taken ? kGreen : kAmber, 2);
  draw_image(canvas, moment);
  draw_panel(canvas, moment);
  return canvas;
}

void write_picture(const std::filesystem::path& file, const cv::Mat& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image, 1);
  write_file_atomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace foresight
