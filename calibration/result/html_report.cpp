#include "calibration/result/html_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "calibration/result/heat_map.hpp"
#include "common/html_page.hpp"
#include "common/svg_plot.hpp"
#include "common/text.hpp"
#include "pictures/encode.hpp"

namespace foresight {
namespace {

// Classes of the style sheet, neighbours far apart in colour.
constexpr std::array<const char*, 8> kColours{"k1", "k6", "k3", "k7", "k0", "k5", "k2", "k4"};
constexpr double kPad = 0.05;  // of the range, around it

SvgPlot::Range range_of(const std::vector<HtmlReport::Series>& series, int axis) {
  double least = INFINITY, most = -INFINITY;
  for (const HtmlReport::Series& s : series)
    for (const Eigen::Vector2d& p : s.points) {
      if (!p.allFinite()) continue;
      least = std::min(least, p[axis]);
      most = std::max(most, p[axis]);
    }
  if (least > most) return {0, 1};
  const double pad = kPad * (most - least);
  return {least - pad, most + pad};
}

std::string card(const std::string& caption, const std::string& content) {
  return "<section class=\"card plot\"><h3>" + escape_html(caption) + "</h3>" + content + "</section>\n";
}

std::string legend(const std::vector<PlotKey>& keys) {
  std::string out;
  for (const PlotKey& key : keys)
    out += std::string("<span><i class=\"") + key.css_class + "\"></i>" + escape_html(key.text) + "</span>";
  return out.empty() ? "" : "<div class=\"legend\">" + out + "</div>";
}

std::vector<PlotKey> keys_of(const std::vector<HtmlReport::Series>& series) {
  std::vector<PlotKey> out;
  for (std::size_t i = 0; i < series.size(); ++i)
    if (!series[i].name.empty()) out.push_back({kColours[i % kColours.size()], series[i].name});
  return out;
}

// A column of figures ("0.31", "12 px", "-") stands to the right.
bool holds_figures(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
  const auto figure = [column](const std::vector<std::string>& row) {
    const std::string& cell = row[column];
    return cell.empty() || cell == "-" || parse_number(cell.substr(0, cell.find(' ')));
  };
  return !rows.empty() && std::all_of(rows.begin(), rows.end(), figure);
}

}  // namespace

HtmlReport::HtmlReport(std::string title, std::string source) : title_(std::move(title)), source_(std::move(source)) {}

void HtmlReport::verdict(const Verdict& verdict) {
  verdict_ = verdict.usable() ? "<section class=\"verdict\"><b>Usable</b></section>\n"
                              : "<section class=\"verdict bad\"><b>Not usable</b>";
  if (verdict.usable()) return;
  for (const Objection& objection : verdict.against)
    verdict_ += "<p>" + escape_html(objection.what) + ". <b>What to do:</b> " + escape_html(objection.cure) + ".</p>";
  verdict_ += "</section>\n";
}

void HtmlReport::heading(const std::string& text) {
  body_ += "<h2>" + escape_html(text) + "</h2>\n";
}

void HtmlReport::paragraph(const std::string& text) {
  body_ += "<p>" + escape_html(text) + "</p>\n";
}

void HtmlReport::table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows) {
  for (const auto& row : rows)
    if (row.size() != columns.size()) throw std::invalid_argument("a table row has another number of cells");
  std::vector<const char*> attributes;
  for (std::size_t c = 0; c < columns.size(); ++c) attributes.push_back(holds_figures(rows, c) ? " class=\"n\"" : "");
  const auto line = [&](const std::string& tag, const std::vector<std::string>& cells) {
    std::string out = "<tr>";
    for (std::size_t c = 0; c < cells.size(); ++c)
      out += "<" + tag + attributes[c] + ">" + escape_html(cells[c]) + "</" + tag + ">";
    return out + "</tr>\n";
  };
  body_ += "<section class=\"card wide\"><table>\n<thead>" + line("th", columns) + "</thead>\n<tbody>\n";
  for (const auto& row : rows) body_ += line("td", row);
  body_ += "</tbody></table></section>\n";
}

void HtmlReport::add_plot(const std::string& caption, SvgPlot& drawn, const std::vector<Series>& series) {
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::vector<double> x, y;
    for (const Eigen::Vector2d& p : series[i].points) {
      x.push_back(p.x());
      y.push_back(p.allFinite() ? p.y() : NAN);
    }
    if (series[i].line)
      drawn.line(x, y, kColours[i % kColours.size()], series[i].name);
    else
      drawn.dots(x, y, kColours[i % kColours.size()], series[i].name);
  }
  plot(caption, drawn, keys_of(series));
}

void HtmlReport::plot(const std::string& caption, const SvgPlot& drawn, const std::vector<PlotKey>& keys) {
  body_ += card(caption, legend(keys) + drawn.str());
  plots_.push_back(drawn.data());
}

void HtmlReport::plot(const std::string& caption, const std::string& x_label, const std::string& y_label,
                      const std::vector<Series>& series, bool equal_scale) {
  SvgPlot plot(caption, range_of(series, 0), range_of(series, 1), x_label, y_label,
               equal_scale ? SvgPlot::Shape::image : SvgPlot::Shape::wide);
  add_plot(caption, plot, series);
}

void HtmlReport::places(const std::string& caption, const std::vector<Series>& series, int width, int height) {
  SvgPlot plot(caption, {-0.5, width - 0.5}, {-0.5, height - 0.5}, "x in px", "y in px", SvgPlot::Shape::image);
  add_plot(caption, plot, series);
}

void HtmlReport::drawing(const std::string& caption, const std::string& svg) {
  body_ += card(caption, svg);
}

void HtmlReport::pictures(const std::vector<Picture>& pictures) {
  constexpr int kQuality = 80;
  if (pictures.empty()) return;
  body_ += "<section class=\"pictures\">\n";
  for (const Picture& picture : pictures) {
    const std::vector<std::uint8_t> jpeg = encode_jpeg(picture.bgr, kQuality);
    body_ += "<figure><img alt=\"" + escape_html(picture.name) + "\" src=\"" + data_uri("image/jpeg", jpeg) +
             "\"><figcaption><b>" + escape_html(picture.name) + "</b> " + escape_html(picture.caption) +
             "</figcaption></figure>\n";
  }
  body_ += "</section>\n";
}

void HtmlReport::heat_map(const std::string& caption, const cv::Mat& values, int width, int height,
                          const std::string& unit) {
  body_ += card(caption, heat_map_svg(caption, values, width, height, unit));
  const std::vector<double> cells(values.begin<double>(), values.end<double>());
  plots_.push_back(map_json(caption, unit, cells, static_cast<std::size_t>(values.cols), width, height));
}

void HtmlReport::write(const std::filesystem::path& file) const {
  const std::string title = escape_html(title_);
  write_page(file,
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             "<meta name=\"generator\" content=\"Foresight\">\n"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
             "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
                 title + "</title>\n<style>\n" + std::string(page_style()) +
                 "</style>\n</head>\n<body>\n<main>\n<header>\n<small>" + escape_html(source_) + "</small>\n<h1>" +
                 title + "</h1>\n</header>\n<div class=\"sheet\">\n" + verdict_ + body_ +
                 "</div>\n</main>\n</body>\n</html>\n",
             title_, plots_);
}

}  // namespace foresight
