#include "apps/bench/margin_plot.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/plot_data.hpp"
#include "texture_gpu/options.hpp"

namespace foresight {
namespace {

struct Curve {
  std::string name;
  const char* colour;
  bool dashed;
  std::function<double(const MarginRow&)> value;  // thousands of texels
};

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
  std::string out = fmt::format("<text x=\"{:.0f}\" y=\"24\" font-weight=\"bold\">{}</text>\n", x0 + kLeft, title);
  const auto grid = [&](double value, const std::string& label) {
    out += fmt::format("<path d=\"M{:.1f} {:.1f}h{:.0f}\" stroke=\"#ddd\"/>", x0 + kLeft, py(value), kWidth);
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">", x0 + kLeft - 6, py(value) + 4);
    out += label + "</text>\n";
  };
  if (logarithmic)
    for (double decade = bottom; decade <= top + 1e-9; ++decade)
      grid(std::pow(10, decade), fmt::format("{:g}", std::pow(10, decade)));
  else
    for (int i = 0; i <= 4; ++i) grid(top * i / 4, fmt::format("{:.0f}", top * i / 4));
  for (const MarginRow& row : rows)
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:g}</text>\n", px(row.error_px),
                       kTop + kHeight + 18, row.error_px);
  out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">registration error [px]</text>\n",
                     x0 + kLeft + kWidth / 2, kTop + kHeight + 36);
  double legend = kTop + kHeight + 58;
  for (const Curve& curve : curves) {
    const char* dash = curve.dashed ? " stroke-dasharray=\"5 4\"" : "";
    std::string path;
    for (const MarginRow& row : rows)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', px(row.error_px), py(curve.value(row)));
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", path, curve.colour, dash);
    for (const MarginRow& row : rows)
      out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>", px(row.error_px),
                         py(curve.value(row)), curve.colour);
    out += fmt::format("\n<path d=\"M{:.1f} {:.1f}h26\" stroke=\"{}\" stroke-width=\"2\"{}/>", x0 + kLeft, legend - 4,
                       curve.colour, dash);
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x0 + kLeft + 34, legend, curve.name);
    legend += 18;
  }
  return out;
}

struct Panel {
  const char* title;
  std::vector<Curve> curves;
  bool logarithmic;
};

std::vector<Panel> panels() {
  constexpr const char* kCore = "#0b6e99";
  constexpr const char* kThesis = "#c4571b";
  return {
      {"Wrong texels [thousands]",
       {{"core without margin", kCore, true, [](const MarginRow& r) { return r.core_without.wrong / 1e3; }},
        {core_with_margin(), kCore, false, [](const MarginRow& r) { return r.core.wrong / 1e3; }},
        {"thesis without expansion", kThesis, true, [](const MarginRow& r) { return r.thesis_without.wrong / 1e3; }},
        {"thesis, 3 shader iterations", kThesis, false, [](const MarginRow& r) { return r.thesis.wrong / 1e3; }}},
       true},
      {"Right texels lost [thousands]",
       {{core_with_margin(), kCore, false,
         [](const MarginRow& r) { return (r.core_without.right - r.core.right) / 1e3; }},
        {"thesis, 3 shader iterations", kThesis, false,
         [](const MarginRow& r) { return (r.thesis_without.right - r.thesis.right) / 1e3; }}},
       false}};
}

}  // namespace

std::string core_with_margin() {
  return fmt::format("core, margin of {:g} px", TextureOptions().margin_px);
}

std::string margin_plot(const std::vector<MarginRow>& rows) {
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"360\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"760\" height=\"360\" fill=\"white\"/>\n";
  double left = 0;
  for (const Panel& one : panels()) {
    out += panel(left, one.title, rows, one.curves, one.logarithmic);
    left += 380;
  }
  return out + "</svg>\n";
}

std::vector<std::string> margin_plot_data(const std::vector<MarginRow>& rows) {
  std::vector<std::string> out;
  for (const Panel& one : panels()) {
    std::vector<PlotSeries> series;
    double most = 0;
    for (const Curve& curve : one.curves) {
      series.push_back({curve.name, "line", {}, {}, {}, {}, {}, {}});
      for (const MarginRow& row : rows) {
        series.back().x.push_back(row.error_px);
        series.back().y.push_back(curve.value(row));
        most = std::max(most, curve.value(row));
      }
    }
    out.push_back(plot_json(one.title, {"px of registration error", 0, rows.empty() ? 1 : rows.back().error_px},
                            {"thousands of texels", 0, most}, series, {}));
  }
  return out;
}

}  // namespace foresight
