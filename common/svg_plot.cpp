#include "common/svg_plot.hpp"

#include <algorithm>
#include <cmath>

#include "common/text.hpp"

namespace foresight {
namespace {

// In user units; the page scales the plot to its column.
constexpr double kWidth = 560, kHeight = 240, kImageHeight = 420, kLeft = 44, kRight = 10, kTop = 20, kBottom = 30;
constexpr double kPlotRight = kWidth - kRight;
constexpr const char* kBars = "bars";
constexpr double kCharacter = 6.5;  // usual width, at the style sheet's size

std::string number(double v) {
  return readable(v, 1);
}

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + number(value) + "\"";
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return "<text" + attribute("x", x) + attribute("y", y) + " text-anchor=\"" + anchor + "\">" + escape_html(text) +
         "</text>";
}

std::string line_between(double x1, double y1, double x2, double y2, const std::string& css_class) {
  return "<line class=\"" + css_class + "\"" + attribute("x1", x1) + attribute("y1", y1) + attribute("x2", x2) +
         attribute("y2", y2) + "/>";
}

SvgPlot::Range drawable(SvgPlot::Range range) {
  if (!std::isfinite(range.min) || !std::isfinite(range.max)) return {0, 1};
  if (range.max - range.min > 1e-12 * std::max(1.0, std::abs(range.max))) return range;
  return {range.min - 0.5, range.min + 0.5};
}

// The same number of units a pixel on both axes: the one that has room to spare is widened around its middle.
void equalise(SvgPlot::Range& x, SvgPlot::Range& y, double width, double height) {
  const double scale = std::max((x.max - x.min) / width, (y.max - y.min) / height);
  const auto widen = [scale](SvgPlot::Range& range, double length) {
    const double middle = (range.min + range.max) / 2;
    range = {middle - scale * length / 2, middle + scale * length / 2};
  };
  widen(x, width);
  widen(y, height);
}

// Digits after the point that tell neighbouring ticks apart.
int digits_for(double step) {
  int digits = 0;
  while (digits < 6 && std::abs(step - std::round(step)) > 1e-6 * step) {
    step *= 10;
    ++digits;
  }
  return digits;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  return out;
}

std::vector<double> round_ticks(SvgPlot::Range range, int count) {
  const double raw = (range.max - range.min) / std::max(1, count);
  const double power = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.5, 2.0, 1.0})
    if (raw <= factor * power * (1 + 1e-9) && (factor != 2.5 || power >= 10)) step = factor * power;
  std::vector<double> ticks;
  // Counted in steps: adding up would drift, and -0 is no tick.
  for (double i = std::ceil(range.min / step - 1e-9); i * step <= range.max + 1e-9 * step; ++i)
    ticks.push_back(i * step + 0.0);
  return ticks;
}

SvgPlot::SvgPlot(const std::string& label, Range x, Range y, const std::string& x_unit, const std::string& y_unit,
                 Shape shape)
    : label_(label), x_unit_(x_unit), y_unit_(y_unit), x_(drawable(x)), y_(drawable(y)), shape_(shape) {
  if (shape_ == Shape::image) equalise(x_, y_, kPlotRight - kLeft, bottom() - kTop);
}

double SvgPlot::height() const {
  return shape_ == Shape::image ? kImageHeight : kHeight;
}

double SvgPlot::bottom() const {
  return height() - kBottom;
}

double SvgPlot::px(double x) const {
  return kLeft + (x - x_.min) / (x_.max - x_.min) * (kPlotRight - kLeft);
}

double SvgPlot::py(double y) const {
  const double share = std::clamp((y - y_.min) / (y_.max - y_.min), 0.0, 1.0);
  const double up = shape_ == Shape::image ? 1 - share : share;
  return bottom() - up * (bottom() - kTop);
}

std::string SvgPlot::points(std::span<const double> x, std::span<const double> y, std::size_t first,
                            std::size_t last) const {
  std::string out;
  for (std::size_t i = first; i < last; ++i) out += number(px(x[i])) + "," + number(py(y[i])) + " ";
  return out;
}

void SvgPlot::line(std::span<const double> x, std::span<const double> y, const std::string& css_class,
                   const std::string& name) {
  series_.push_back(
      {name.empty() ? css_class : name, "line", {x.begin(), x.end()}, {y.begin(), y.end()}, {}, {}, {}, {}});
  std::size_t first = 0;
  while (first < x.size()) {
    std::size_t last = first;
    while (last < x.size() && std::isfinite(y[last])) ++last;
    if (last - first == 1)
      body_ += "<circle class=\"dot " + css_class + "\"" + attribute("cx", px(x[first])) +
               attribute("cy", py(y[first])) + " r=\"2.5\"/>";
    else if (last > first)
      body_ += "<polyline class=\"line " + css_class + "\" points=\"" + points(x, y, first, last) + "\"/>";
    first = last + 1;
  }
}

void SvgPlot::area(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                   const std::string& css_class, const std::string& name) {
  series_.push_back({name.empty() ? css_class : name,
                     "area",
                     {x.begin(), x.end()},
                     {},
                     {},
                     {},
                     {low.begin(), low.end()},
                     {high.begin(), high.end()}});
  std::vector<double> back_x, back_y;
  std::string forth;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(low[i]) || !std::isfinite(high[i])) continue;
    forth += number(px(x[i])) + "," + number(py(high[i])) + " ";
    back_x.insert(back_x.begin(), x[i]);
    back_y.insert(back_y.begin(), low[i]);
  }
  if (back_x.size() < 2) return;
  body_ +=
      "<polygon class=\"area " + css_class + "\" points=\"" + forth + points(back_x, back_y, 0, back_x.size()) + "\"/>";
}

void SvgPlot::dots(std::span<const double> x, std::span<const double> y, const std::string& css_class,
                   const std::string& name) {
  series_.push_back(
      {name.empty() ? css_class : name, "dots", {x.begin(), x.end()}, {y.begin(), y.end()}, {}, {}, {}, {}});
  const auto inside = [](double v, const Range& range) { return v >= range.min && v <= range.max; };
  std::string path;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (inside(x[i], x_) && inside(y[i], y_)) path += "M" + number(px(x[i])) + " " + number(py(y[i])) + "h0";
  if (!path.empty()) body_ += "<path class=\"dots " + css_class + "\" d=\"" + path + "\"/>";
}

void SvgPlot::bar(Range x, Range y, const std::string& css_class, const std::string& name) {
  const std::string& called = name.empty() ? css_class : name;
  if (series_.empty() || series_.back().kind != kBars || series_.back().name != called)
    series_.push_back({called, kBars, {}, {}, {}, {}, {}, {}});
  PlotSeries& bars = series_.back();
  bars.left.push_back(x.min), bars.right.push_back(x.max);
  bars.low.push_back(y.min), bars.high.push_back(y.max);
  if (!std::isfinite(y.min) || !std::isfinite(y.max) || y.max <= y.min) return;
  const double left = px(x.min), right = px(x.max), top = py(y.max), low = py(y.min);
  body_ += "<rect class=\"area " + css_class + "\"" + attribute("x", left) + " y=\"" + readable(top, 2) + "\"" +
           attribute("width", std::max(0.5, right - left)) + " height=\"" + readable(low - top, 2) + "\"/>";
}

void SvgPlot::mark_y(double y, const std::string& text, const std::string& css_class) {
  if (!std::isfinite(y)) return;
  marks_.push_back({"y", y, text});
  body_ += line_between(kLeft, py(y), kPlotRight, py(y), "mark " + css_class) +
           text_at(kPlotRight - 4, py(y) - 5, "end", text);
}

void SvgPlot::mark_x(double x, const std::string& text, const std::string& css_class) {
  if (!std::isfinite(x)) return;
  marks_.push_back({"x", x, text});
  const bool left_half = px(x) < (kLeft + kPlotRight) / 2;
  body_ += line_between(px(x), kTop, px(x), bottom(), "mark " + css_class) +
           text_at(px(x) + (left_half ? 5 : -5), kTop + 9, left_half ? "start" : "end", text);
}

void SvgPlot::readout(std::span<const double> x, std::span<const Series> series, int digits, const std::string& unit) {
  const auto list = [](std::span<const double> values, int places) {
    std::string out;
    for (const double v : values) out += (out.empty() ? "" : ",") + (std::isfinite(v) ? readable(v, places) : "null");
    return "[" + out + "]";
  };
  std::string names, rows;
  for (const Series& s : series) {
    names += (names.empty() ? "\"" : ",\"") + s.name + "\"";
    rows += (rows.empty() ? "" : ",") + list(s.values, digits);
  }
  std::vector<double> at;
  for (const double v : x) at.push_back((px(v) - kLeft) / (kPlotRight - kLeft));
  readout_ = " data-readout=\"" +
             escape_html("{\"unit\":\"" + unit + "\",\"at\":" + list(at, 4) + ",\"x\":" + list(x, 3) + ",\"names\":[" +
                         names + "],\"rows\":[" + rows + "]}") +
             "\"";
}

std::string SvgPlot::data() const {
  return plot_json(label_, {x_unit_, x_.min, x_.max}, {y_unit_, y_.min, y_.max}, series_, marks_);
}

std::string SvgPlot::str() const {
  std::string out = "<svg viewBox=\"0 0 560 " + number(height()) + "\" role=\"img\" aria-label=\"" +
                    escape_html(label_) + "\"" + readout_ + ">";
  const auto y_ticks = round_ticks(y_, shape_ == Shape::image ? 7 : 4), x_ticks = round_ticks(x_, 6);
  const int y_digits = y_ticks.size() > 1 ? digits_for(y_ticks[1] - y_ticks[0]) : 1;
  const int x_digits = x_ticks.size() > 1 ? digits_for(x_ticks[1] - x_ticks[0]) : 1;
  std::string labels;
  for (const double t : y_ticks) {
    out += line_between(kLeft, py(t), kPlotRight, py(t), "grid");
    labels += text_at(kLeft - 7, py(t) + 4, "end", readable(t, y_digits));
  }
  const double unit_width = std::max(24.0, kCharacter * static_cast<double>(x_unit_.size()) + 16);
  for (const double t : x_ticks) {
    if (px(t) > kPlotRight - unit_width) continue;
    labels += text_at(px(t), bottom() + 18, "middle", readable(t, x_digits));
  }
  labels += text_at(4, kTop - 8, "start", y_unit_) + text_at(kPlotRight, bottom() + 18, "end", x_unit_);
  return out + body_ + "<g class=\"labels\">" + labels + "</g><line class=\"cursor\" y1=\"" + number(kTop) +
         "\" y2=\"" + number(bottom()) + "\"/></svg>";
}

}  // namespace foresight
