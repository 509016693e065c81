#include "apps/bench/margin_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "texture_gpu/options.hpp"

namespace foresight {
namespace {

struct Curve {
  std::string name;
  const char* colour;
  bool dashed;
  std::function<double(const MarginRow&)> value;  // thousands of texels
};

std::string formatted(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// One diagram of 360 x 260 with its left edge at x0.
std::string panel(double x0, const char* title, const std::vector<MarginRow>& rows, const std::vector<Curve>& curves,
                  bool logarithmic) {
  constexpr double kLeft = 62, kTop = 44, kWidth = 280, kHeight = 170, kFloor = 0.01;
  double most = kFloor;
  for (const Curve& curve : curves)
    for (const MarginRow& row : rows) most = std::max(most, curve.value(row));
  const double top = logarithmic ? std::ceil(std::log10(most)) : 40 * std::ceil(most / 40);
  const double bottom = logarithmic ? std::log10(kFloor) : 0;
  const auto px = [&](double error) { return x0 + kLeft + kWidth * error / rows.back().error_px; };
  const auto py = [&](double value) {
    const double v = logarithmic ? std::log10(std::max(value, kFloor)) : value;
    return kTop + kHeight * (1 - (v - bottom) / (top - bottom));
  };
  std::string out = formatted("<text x=\"%.0f\" y=\"24\" font-weight=\"bold\">%s</text>\n", x0 + kLeft, title);
  const auto grid = [&](double value, const char* format) {
    out += formatted("<path d=\"M%.1f %.1fh%.0f\" stroke=\"#ddd\"/>", x0 + kLeft, py(value), kWidth);
    out += formatted("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", x0 + kLeft - 6, py(value) + 4);
    out += formatted(format, value) + "</text>\n";
  };
  if (logarithmic)
    for (double decade = bottom; decade <= top + 1e-9; ++decade) grid(std::pow(10, decade), "%g");
  else
    for (int i = 0; i <= 4; ++i) grid(top * i / 4, "%.0f");
  for (const MarginRow& row : rows)
    out += formatted("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%g</text>\n", px(row.error_px),
                     kTop + kHeight + 18, row.error_px);
  out += formatted("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">registration error [px]</text>\n",
                   x0 + kLeft + kWidth / 2, kTop + kHeight + 36);
  double legend = kTop + kHeight + 58;
  for (const Curve& curve : curves) {
    const char* dash = curve.dashed ? " stroke-dasharray=\"5 4\"" : "";
    std::string path;
    for (const MarginRow& row : rows)
      path += formatted("%c%.1f %.1f", path.empty() ? 'M' : 'L', px(row.error_px), py(curve.value(row)));
    out += formatted("<path d=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"%s/>\n", path.c_str(), curve.colour,
                     dash);
    for (const MarginRow& row : rows)
      out += formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\"/>", px(row.error_px), py(curve.value(row)),
                       curve.colour);
    out += formatted("\n<path d=\"M%.1f %.1fh26\" stroke=\"%s\" stroke-width=\"2\"%s/>", x0 + kLeft, legend - 4,
                     curve.colour, dash);
    out += formatted("<text x=\"%.1f\" y=\"%.1f\">%s</text>\n", x0 + kLeft + 34, legend, curve.name);
    legend += 18;
  }
  return out;
}

}  // namespace

std::string core_with_margin() {
  return formatted("core, margin of %g px", TextureOptions().margin_px);
}

std::string margin_plot(const std::vector<MarginRow>& rows) {
  constexpr const char* kCore = "#0b6e99";
  constexpr const char* kThesis = "#c4571b";
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"360\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"760\" height=\"360\" fill=\"white\"/>\n";
  out += panel(
      0, "Wrong texels [thousands]", rows,
      {{"core without margin", kCore, true, [](const MarginRow& r) { return r.core_without.wrong / 1e3; }},
       {core_with_margin(), kCore, false, [](const MarginRow& r) { return r.core.wrong / 1e3; }},
       {"thesis without expansion", kThesis, true, [](const MarginRow& r) { return r.thesis_without.wrong / 1e3; }},
       {"thesis, 3 shader iterations", kThesis, false, [](const MarginRow& r) { return r.thesis.wrong / 1e3; }}},
      true);
  out += panel(380, "Right texels lost [thousands]", rows,
               {{core_with_margin(), kCore, false,
                 [](const MarginRow& r) { return (r.core_without.right - r.core.right) / 1e3; }},
                {"thesis, 3 shader iterations", kThesis, false,
                 [](const MarginRow& r) { return (r.thesis_without.right - r.thesis.right) / 1e3; }}},
               false);
  return out + "</svg>\n";
}

}  // namespace foresight
