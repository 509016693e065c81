// Small plots as inline SVG. Colours come from the page's style sheet by class, so that a plot
// follows light and dark mode. Not thread safe; no errors: what is not finite leaves a gap.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/plot_data.hpp"

namespace foresight {

/// `text` with & < > " ' replaced, for use as HTML text or attribute value.
std::string escape_html(std::string_view text);

class SvgPlot {
 public:
  struct Range {
    double min = 0;
    double max = 1;
  };

  enum class Shape {
    wide,   ///< over time and the like
    image,  ///< places in an image: taller, the same scale on both axes, y down
  };

  /// Widens an empty or non-finite range, so that it can be drawn. `label`: what the plot shows, for
  /// screen readers; `x_unit`, `y_unit`: written at the ends of the axes.
  SvgPlot(const std::string& label, Range x, Range y, const std::string& x_unit, const std::string& y_unit,
          Shape shape = Shape::wide);

  /// A line through (x[i], y[i]). `name`: of the series in data(), here and below; without one, its class.
  void line(std::span<const double> x, std::span<const double> y, const std::string& css_class,
            const std::string& name = "");

  /// The area between two curves over the same x.
  void area(std::span<const double> x, std::span<const double> low, std::span<const double> high,
            const std::string& css_class, const std::string& name = "");

  /// A dot at every (x[i], y[i]) that lies inside both ranges.
  void dots(std::span<const double> x, std::span<const double> y, const std::string& css_class,
            const std::string& name = "");

  /// Bars of one name are one series.
  void bar(Range x, Range y, const std::string& css_class, const std::string& name = "");

  /// A dashed line across the plot, with a text at its end.
  void mark_y(double y, const std::string& text, const std::string& css_class);
  void mark_x(double x, const std::string& text, const std::string& css_class);

  /// A row that the page shows beside the pointer: `values` has one entry per x of the series.
  struct Series {
    std::string name;
    std::vector<double> values;
  };
  void readout(std::span<const double> x, std::span<const Series> series, int digits, const std::string& unit);

  std::string str() const;
  /// What was drawn, all of it, as JSON (plot_data.hpp).
  std::string data() const;

 private:
  double px(double x) const;
  double py(double y) const;
  double height() const;
  double bottom() const;
  std::string points(std::span<const double> x, std::span<const double> y, std::size_t first, std::size_t last) const;

  std::string label_, x_unit_, y_unit_, body_, readout_;
  Range x_, y_;
  Shape shape_;
  std::vector<PlotSeries> series_;
  std::vector<PlotMark> marks_;
};

/// About `count` round values (1, 2 or 5, from 25 on also 2.5, times a power of ten apart) inside the range.
std::vector<double> round_ticks(SvgPlot::Range range, int count);

}  // namespace foresight
