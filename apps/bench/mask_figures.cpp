#include "apps/bench/mask_figures.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "apps/replay_report/contact_sheet.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

using thesis::Expansion;
using thesis::HoleFilling;

constexpr int kMaskWidth = 420, kTextureWidth = 512;  // px on the page
constexpr uchar kGrey = 150;

/// White: valid, black: invalid, grey: outside of the polygon.
cv::Mat readable_mask(const cv::Mat& mask) {
  cv::Mat grey(mask.size(), CV_8UC1, cv::Scalar(kGrey)), out;
  grey.setTo(255, mask == 255);
  grey.setTo(0, mask < 128);
  cv::cvtColor(grey, out, cv::COLOR_GRAY2BGR);
  return out;
}

std::string valid_share(const cv::Mat& mask) {
  return readable(100.0 * cv::countNonZero(mask == 255) / static_cast<double>(mask.total()), 0, " % valid");
}

cv::Mat scaled_to(const cv::Mat& picture, int width) {
  const double factor = 1.0 * width / picture.cols;
  cv::Mat out;
  cv::resize(picture, out, {width, std::max(1, static_cast<int>(std::lround(picture.rows * factor)))}, 0, 0,
             factor < 1 ? cv::INTER_AREA : cv::INTER_NEAREST);
  return out;
}

std::string name_of(const FigureLab& lab, const thesis::Polygon& polygon) {
  return "'" + lab.run().scene()->nodes()[static_cast<std::size_t>(polygon.node)].name + "'";
}

/// The texture as it would be drawn: holes are pink unless they were filled.
cv::Mat texture_picture(const thesis::PolygonTextures& textures, std::size_t polygon, bool filled) {
  cv::Mat texels = textures.read(polygon);
  for (int y = 0; y < texels.rows; ++y)
    for (int x = 0; x < texels.cols; ++x) {
      uchar& alpha = texels.at<cv::Vec4b>(y, x)[3];
      alpha = filled || alpha >= 128 ? 255 : 64;
    }
  return scaled_to(pink_holes(texels), kTextureWidth);
}

}  // namespace

FigurePage mask_figure(const FigureLab& lab, const FigurePair& pair) {
  const PosedImage image = lab.load(pair.from);
  FigureTextures textures(lab.run(), figure_options(), true);
  const std::size_t chosen = choose_half_hidden(lab, textures, image);
  const thesis::Polygon& polygon = textures.pipeline.textures().polygons()[chosen];
  FigurePage page{"Figure 5.11: alpha mask of the largest partly hidden polygon (of " + name_of(lab, polygon) +
                      ") in image " + std::to_string(pair.from) +
                      ". White: valid, black: invalid, grey: outside of the polygon",
                  3,
                  {}};
  const std::pair<Expansion, std::string> methods[] = {
      {Expansion::alternating, "Alternating"}, {Expansion::progressive, "Progressive"}, {Expansion::shader, "Shader"}};
  for (int iterations = 0; iterations <= 10; iterations += 2)
    for (const auto& [method, name] : methods) {
      const cv::Mat mask = textures.pipeline.alpha_mask(image, chosen, method, iterations);
      page.panels.push_back({scaled_to(readable_mask(mask), kMaskWidth),
                             name + ", " + std::to_string(iterations) + " iterations: " + valid_share(mask)});
    }
  return page;
}

FigurePage filling_figure(const FigureLab& lab, const FigurePair& pair) {
  thesis::Options options;  // as the thesis runs
  options.hole_filling = HoleFilling::none;
  const auto extracted = lab.extract(lab.load(pair.from), options);
  const std::size_t chosen = choose_texture_with_holes(*extracted);
  const thesis::PolygonTextures& all = extracted->pipeline.textures();
  const gl::Texture& texture = *all.find(chosen);
  const int s = all.frame(chosen).s, t = all.frame(chosen).t;
  FigurePage page{"Figure 5.23: texture of a polygon of " + name_of(lab, all.polygons()[chosen]) + " from image " +
                      std::to_string(pair.from) + ", " + std::to_string(s) + " x " + std::to_string(t) + " texels",
                  2,
                  {}};
  const auto add = [&](bool filled, const char* caption) {
    page.panels.push_back({texture_picture(all, chosen, filled), caption});
  };
  add(false, "a) With holes (pink)");
  // Filling keeps the alpha, so that each method finds the same holes.
  const thesis::TexelDrawing drawing;
  thesis::ShaderFilling shader(all.max_texture());
  shader(texture, s, t, {.two_stages = false, .query = true}, drawing);
  add(true, "b) Filled by the shader's first stage alone");
  shader(texture, s, t, {.two_stages = true, .query = true}, drawing);
  add(true, "c) Filled by the shader's two stages");
  thesis::PyramidFilling(all.max_texture())(texture, s, t, drawing);
  add(true, "d) Filled from the pyramid");
  return page;
}

}  // namespace foresight
