// A self-contained HTML page: text, tables, and plots as inline SVG; it needs no network and no script.
// All text is escaped. Plots that follow each other stand side by side where the page is wide enough.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calibration/result/verdict.hpp"

namespace foresight {

class SvgPlot;

/// What a colour of a plot stands for.
struct PlotKey {
  const char* css_class;
  std::string text;
};

class HtmlReport {
 public:
  struct Series {
    std::string name;
    std::vector<Eigen::Vector2d> points;
    bool line = false;  ///< joined by a line instead of dots
  };

  /// `source`: the command that makes it, above the title.
  explicit HtmlReport(std::string title, std::string source = "foresight calibrate");

  /// Stands before all else, whenever it is called.
  void verdict(const Verdict& verdict);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// Columns of figures stand to the right. Throws std::invalid_argument where a row has not as many cells as
  /// `columns`.
  void table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows);

  /// A drawing that is SVG already, under its caption.
  void drawing(const std::string& caption, const std::string& svg);

  struct Picture {
    cv::Mat bgr;          ///< as it is to be seen; some hundred px wide
    std::string name;     ///< of the view
    std::string caption;  ///< beside the name
  };
  /// A sheet of pictures side by side.
  void pictures(const std::vector<Picture>& pictures);

  /// Places in an image of width x height px, all of which is shown.
  void places(const std::string& caption, const std::vector<Series>& series, int width, int height);

  /// Axes with round ticks and units in their labels. `equal_scale`: for residuals and places in an image,
  /// y goes down as there. What is not finite leaves a gap.
  void plot(const std::string& caption, const std::string& x_label, const std::string& y_label,
            const std::vector<Series>& series, bool equal_scale = false);

  /// A plot drawn by somebody else.
  void plot(const std::string& caption, const SvgPlot& drawn, const std::vector<PlotKey>& keys);

  /// A map over the image (CV_64F, any size, stretched to width x height px) with a colour bar; see heat_map.hpp.
  void heat_map(const std::string& caption, const cv::Mat& values, int width, int height, const std::string& unit);

  /// Writes the page, and where it has plots their series beside it (common/plot_data.hpp), both or none. Throws
  /// RuntimeFailure where that cannot be.
  void write(const std::filesystem::path& file) const;

  const std::string& body() const { return body_; }

 private:
  void add_plot(const std::string& caption, SvgPlot& plot, const std::vector<Series>& series);

  std::string title_, source_;
  std::string verdict_;
  std::string body_;
  std::vector<std::string> plots_;  // JSON
};

}  // namespace foresight
