#include "apps/bench/figure_subjects.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/error.hpp"
#include "pictures/view_alpha.hpp"

namespace foresight {
namespace {

constexpr int kStarts = 4;     // images tried as the first of a pair
constexpr int kPolygons = 24;  // largest polygons in view tried for their mask
constexpr int kClearly = 40;   // 8-bit values
constexpr int kMarkedVisible = 255, kMarkedHidden = 0;

[[noreturn]] void nothing_hidden(const FigureLab& lab) {
  throw InputError(lab.run().root().string(), "nothing in it hides anything else that a later image shows",
                   "take a run with things in front of others, such as one of `foresight synth`");
}

cv::Mat alpha_of(const cv::Mat& view) {
  cv::Mat alpha;
  cv::extractChannel(view, alpha, 3);
  return alpha;
}

/// Pixels that only an extraction without the occlusion test gives a colour: doubles of what hid them.
double doubles(const cv::Mat& without, const cv::Mat& with) {
  const cv::Mat coloured = alpha_of(without) == view_alpha::kFromImage;
  const cv::Mat doubled = coloured & (alpha_of(with) < view_alpha::kFromFill);
  const double beyond = static_cast<double>(coloured.total()) - cv::countNonZero(coloured);
  return cv::countNonZero(doubled) - 0.5 * beyond;
}

/// 255 where any channel differs clearly.
cv::Mat unlike(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  std::vector<cv::Mat> channels;
  cv::split(difference, channels);
  return cv::max(cv::max(channels[0], channels[1]), channels[2]) > kClearly;
}

/// Texels of holes, times the contrast of the colours around them. Holes at the texture's border count
/// little: most of these lie beyond the image.
double hole_score(const cv::Mat& texels) {
  const cv::Mat holes = alpha_of(texels) < 128;
  cv::Mat labels, boxes, centres;
  const int count = cv::connectedComponentsWithStats(holes, labels, boxes, centres);
  double score = 0;
  for (int i = 1; i < count; ++i) {
    const int* box = boxes.ptr<int>(i);
    const bool inside = box[cv::CC_STAT_LEFT] > 0 && box[cv::CC_STAT_TOP] > 0 &&
                        box[cv::CC_STAT_LEFT] + box[cv::CC_STAT_WIDTH] < holes.cols &&
                        box[cv::CC_STAT_TOP] + box[cv::CC_STAT_HEIGHT] < holes.rows;
    cv::Mat wider, rim;
    cv::dilate(labels == i, wider, {}, {-1, -1}, 2);
    rim = wider & ~holes;
    cv::Scalar mean, deviation;
    cv::meanStdDev(texels, mean, deviation, rim);
    score += (inside ? 1 : 0.01) * box[cv::CC_STAT_AREA] * (1 + deviation[0] + deviation[1] + deviation[2]);
  }
  return cv::countNonZero(holes) < static_cast<int>(holes.total()) ? score : 0;
}

cv::Mat bgr_of(const cv::Mat& view) {
  cv::Mat bgr;
  cv::cvtColor(view, bgr, cv::COLOR_BGRA2BGR);
  return bgr;
}

}  // namespace

FigurePair choose_pair(const FigureLab& lab) {
  thesis::Options with = figure_options(), without = with;
  without.occlusion = false;
  const std::size_t count = lab.run().frames().size();
  FigurePair best;
  double most = -1e30;
  for (std::size_t k = 0; k < kStarts; ++k) {
    const std::size_t from = k * count / (2 * kStarts);
    const PosedImage image = lab.load(from);
    const auto tested = lab.extract(image, with), untested = lab.extract(image, without);
    for (const std::size_t ahead : {count / 4, count / 2, 3 * count / 4}) {
      if (from + ahead >= count) continue;
      const double score = doubles(lab.look(*untested, from + ahead), lab.look(*tested, from + ahead));
      if (score <= most) continue;
      most = score;
      best = {from, from + ahead};
    }
  }
  const auto tested = lab.extract(lab.load(best.from), with);
  if (cv::countNonZero(alpha_of(lab.look(*tested, best.to)) < view_alpha::kFromFill) == 0) nothing_hidden(lab);
  return best;
}

std::size_t choose_half_hidden(const FigureLab& lab, FigureTextures& textures, const PosedImage& image) {
  const auto& polygons = textures.pipeline.textures().polygons();
  const gl::Faces plane = gl::faces_for(lab.run().lens_left(), 2);
  const Pose T_camera_world = image.T_world_camera.inverse();
  std::vector<std::pair<int, std::size_t>> by_size;  // px
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const Pose& T_world_node = image.scene.T_world_node[static_cast<std::size_t>(polygons[i].node)];
    if (const auto box = thesis::bounding_box(polygons[i], T_camera_world * T_world_node, plane))
      by_size.emplace_back(box->width * box->height, i);
  }
  std::sort(by_size.rbegin(), by_size.rend());
  by_size.resize(std::min<std::size_t>(by_size.size(), kPolygons));
  int most = 0;
  std::size_t best = 0;
  for (const auto& [size, i] : by_size) {
    const cv::Mat mask = textures.pipeline.alpha_mask(image, i, thesis::Expansion::none, 0);
    const int score = std::min(cv::countNonZero(mask == kMarkedVisible), cv::countNonZero(mask == kMarkedHidden));
    if (score > most) best = i;
    most = std::max(most, score);
  }
  if (most == 0) nothing_hidden(lab);
  return best;
}

std::size_t choose_texture_with_holes(const FigureTextures& textures) {
  const thesis::PolygonTextures& all = textures.pipeline.textures();
  double most = 0;
  std::size_t best = 0;
  for (std::size_t i = 0; i < all.polygons().size(); ++i) {
    if (!all.find(i) || !all.has_colours(i)) continue;
    const double score = hole_score(all.read(i));
    if (score > most) best = i;
    most = std::max(most, score);
  }
  if (most == 0)
    throw InputError("RUN", "no surface of its model is seen in part", "take a run with the model in view");
  return best;
}

int choose_direction(const FigureLab& lab, const FigurePair& pair, double mean_px) {
  const PosedImage image = lab.load(pair.from);
  const cv::Mat actual = as_colour(lab.load(pair.to).pixels);
  thesis::Options cleaning = figure_options();
  cleaning.expansion = thesis::Expansion::alternating;
  cleaning.iterations = 2;
  int best = 0, most = -1;
  for (int direction = 0; direction < 4; ++direction) {
    const PosedImage wrong = misregistered(image, lab.run().lens_left(), mean_px, direction);
    const cv::Mat raw = lab.look(*lab.extract(wrong, figure_options()), pair.to);
    const cv::Mat cleaned = lab.look(*lab.extract(wrong, cleaning), pair.to);
    const cv::Mat mask = removed_errors(raw, cleaned, actual);
    const int score = cv::countNonZero(mask(choose_detail(mask)));
    if (score > most) best = direction;
    most = std::max(most, score);
  }
  return best;
}

cv::Mat removed_errors(const cv::Mat& raw, const cv::Mat& cleaned, const cv::Mat& actual) {
  const cv::Mat removed = (alpha_of(raw) == view_alpha::kFromImage) & (alpha_of(cleaned) < view_alpha::kFromFill) &
                          unlike(bgr_of(raw), actual);
  // Where a wide hole has opened since, the wrong colours stand apart from what they belong to.
  cv::Mat wide, beside;
  const int size = 2 * (raw.cols / 160) + 3;
  cv::morphologyEx(alpha_of(raw) < view_alpha::kFromFill, wide, cv::MORPH_OPEN, cv::Mat::ones(size, size, CV_8U));
  cv::dilate(wide, beside, cv::Mat::ones(2 * size + 1, 2 * size + 1, CV_8U));
  const cv::Mat apart = removed & beside;
  return cv::countNonZero(apart) ? apart : removed;
}

cv::Mat mended_errors(const cv::Mat& raw, const cv::Mat& better, const cv::Mat& actual) {
  return unlike(bgr_of(raw), actual) & ~unlike(bgr_of(better), actual);
}

cv::Mat differences(const cv::Mat& a, const cv::Mat& b) {
  const cv::Mat coloured_a = alpha_of(a) >= view_alpha::kFromFill, coloured_b = alpha_of(b) >= view_alpha::kFromFill;
  return (coloured_a ^ coloured_b) | (unlike(bgr_of(a), bgr_of(b)) & coloured_a & coloured_b);
}

cv::Rect choose_detail(const cv::Mat& mask, int factor) {
  const cv::Size size(std::max(1, mask.cols / factor), std::max(1, mask.rows / factor));
  cv::Mat sums;
  cv::integral(mask, sums, CV_64F);
  cv::Rect best({(mask.cols - size.width) / 2, (mask.rows - size.height) / 2}, size);
  double most = 0;
  for (int y = 0; y + size.height <= mask.rows; ++y)
    for (int x = 0; x + size.width <= mask.cols; ++x) {
      const double sum = sums.at<double>(y + size.height, x + size.width) - sums.at<double>(y, x + size.width) -
                         sums.at<double>(y + size.height, x) + sums.at<double>(y, x);
      if (sum <= most) continue;
      most = sum;
      best = {{x, y}, size};
    }
  return best;
}

cv::Mat as_colour(const cv::Mat& pixels) {
  cv::Mat colour = pixels;
  if (pixels.channels() == 1) cv::cvtColor(pixels, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace foresight
