#include "apps/bench/view_figures.hpp"

#include <algorithm>

#include "apps/replay_report/contact_sheet.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

using thesis::Expansion;
using thesis::HoleFilling;

constexpr int kFillingFactor = 2, kDoubleFactor = 2;  // of enlarged details
constexpr double kErrorShare = 0.006;  // registration error in image widths: 4 or 5 px at the default size

std::string taken_and_seen(const FigureLab& lab, const FigurePair& pair) {
  const auto& frames = lab.run().frames();
  const Duration later = frames[pair.to].left.time - frames[pair.from].left.time;
  return "texture from image " + std::to_string(pair.from) + ", seen from the pose of image " +
         std::to_string(pair.to) + ", " + readable(to_seconds(later), 2, " s") + " later";
}

void add_with_detail(FigurePage& page, const cv::Mat& view, const cv::Rect& detail, const std::string& caption,
                     const std::string& detail_caption) {
  const cv::Mat picture = pink_holes(view);
  page.panels.push_back({outlined(picture, detail), caption});
  page.panels.push_back({enlarged(picture, detail, kDetailFactor), detail_caption});
}

cv::Mat look(const FigureLab& lab, const PosedImage& image, const thesis::Options& options, std::size_t to) {
  return lab.look(*lab.extract(image, options), to);
}

/// The window of 1 / kFillingFactor of `size` with `detail` in its middle, as far as that goes.
cv::Rect surroundings(const cv::Rect& detail, cv::Size size) {
  cv::Rect out(0, 0, std::max(1, size.width / kFillingFactor), std::max(1, size.height / kFillingFactor));
  out.x = std::clamp(detail.x + (detail.width - out.width) / 2, 0, size.width - out.width);
  out.y = std::clamp(detail.y + (detail.height - out.height) / 2, 0, size.height - out.height);
  return out;
}

thesis::Options expanded(int iterations, HoleFilling filling) {
  thesis::Options options = figure_options();
  options.expansion = iterations ? Expansion::alternating : Expansion::none;
  options.iterations = iterations;
  options.hole_filling = filling;
  return options;
}

}  // namespace

FigurePage occlusion_figure(const FigureLab& lab, const FigurePair& pair) {
  const PosedImage image = lab.load(pair.from);
  thesis::Options options = figure_options();
  const cv::Mat with = look(lab, image, options, pair.to);
  options.occlusion = false;
  const cv::Mat without = look(lab, image, options, pair.to);
  const cv::Rect detail = choose_detail(differences(without, with), kDoubleFactor);
  FigurePage page{"Figure 4.8: " + taken_and_seen(lab, pair), 2, {}};
  page.panels = {{as_colour(image.pixels), "The camera image that the texture is from"},
                 {outlined(pink_holes(with), detail), "The later view, with occlusion test"},
                 {enlarged(pink_holes(without), detail, kDoubleFactor),
                  "Detail without occlusion test: what stood in front is painted on what was behind it, too"},
                 {enlarged(pink_holes(with), detail, kDoubleFactor),
                  "The same detail with occlusion test: hidden texels are invalid (pink)"}};
  return page;
}

BorderFigures border_figures(const FigureLab& lab, const FigurePair& pair) {
  const PosedImage image = lab.load(pair.from);
  thesis::Options options = figure_options();
  options.texels_per_metre = thesis::Options().texels_per_metre;  // lines are texels wide
  options.max_texture = thesis::Options().max_texture;
  const cv::Mat with = look(lab, image, options, pair.to);
  options.clean_borders = false;
  const cv::Mat without = look(lab, image, options, pair.to);
  const cv::Rect detail = choose_detail(mended_errors(without, with, as_colour(lab.load(pair.to).pixels)));
  const std::string where = taken_and_seen(lab, pair);
  BorderFigures figures{{"Figure 4.15: " + where, 2, {}}, {"Figure 4.20: " + where, 2, {}}};
  add_with_detail(figures.without, without, detail,
                  "Without the measures of section 4.5.3: holes and dark texels along the borders of polygons",
                  "Detail, enlarged 4 times");
  add_with_detail(figures.with, with, detail,
                  "With them (line border, bounding box normalised, alpha 31/32 outside): neighbours meet",
                  "The same detail, enlarged 4 times");
  return figures;
}

ErrorFigures error_figures(const FigureLab& lab, const FigurePair& pair) {
  const Lens& lens = lab.run().lens_left();
  const double error_px = std::max(2.0, std::round(kErrorShare * lens.width()));
  const PosedImage wrong = misregistered(lab.load(pair.from), lens, error_px, choose_direction(lab, pair, error_px));
  const std::string title =
      "registration error of " + readable(error_px, 0, " px") + " (mean); " + taken_and_seen(lab, pair);
  ErrorFigures figures{{"Figure 5.9: " + title, 3, {}}, {"Figure 5.19: detail with a " + title, 2, {}}};

  const cv::Mat actual = as_colour(lab.load(pair.to).pixels);
  cv::Mat views[3];
  for (int i = 0; i < 3; ++i) views[i] = look(lab, wrong, expanded(i, HoleFilling::none), pair.to);
  const cv::Rect detail = choose_detail(removed_errors(views[0], views[2], actual));
  const char* captions[] = {"No expansion: the rim of what stood in front is painted on what is behind it",
                            "One iteration (alternating)", "Two iterations (alternating)"};
  for (int i = 0; i < 3; ++i) figures.expansion.panels.push_back({outlined(pink_holes(views[i]), detail), captions[i]});
  for (const cv::Mat& view : views)
    figures.expansion.panels.push_back({enlarged(pink_holes(view), detail, kDetailFactor), "Detail, enlarged 4 times"});

  const cv::Mat filled[] = {look(lab, wrong, expanded(0, HoleFilling::pyramid), pair.to),
                            look(lab, wrong, expanded(2, HoleFilling::pyramid), pair.to)};
  const cv::Rect around = surroundings(detail, views[0].size());
  const std::pair<cv::Mat, const char*> fillings[] = {
      {views[0], "a) No expansion, no hole filling"},
      {filled[0], "b) No expansion, holes filled: the wrong colours are spread into the holes"},
      {views[2], "c) Two iterations of expansion, no hole filling"},
      {filled[1], "d) Two iterations of expansion, holes filled"}};
  for (const auto& [view, caption] : fillings)
    figures.filling.panels.push_back({enlarged(pink_holes(view), around, kFillingFactor), caption});
  return figures;
}

}  // namespace foresight
