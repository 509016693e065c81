// The series of plots as JSON beside the page that shows them, so that others can draw their own.
//
//   FILE.plots.json of FILE: {"generator": "foresight", "title": "...", "plots": [{"title": "...",
//     "x": {"unit": "s", "range": [0, 12]}, "y": {"unit": "dB", "range": [20, 40]}, "series": [
//       {"name": "predicted", "kind": "line" or "dots", "x": [...], "y": [...]},
//       {"name": "seen", "kind": "area", "x": [...], "low": [...], "high": [...]},
//       {"name": "images", "kind": "bars", "left": [...], "right": [...], "low": [...], "high": [...]}],
//     "marks": [{"axis": "x" or "y", "at": 3.2, "text": "p50 3.2 ms"}]}]}
//
// Values have all their digits; null is one that was not measured. A map over an image has "size_px": [w, h] and
// "cells": [[...], ...], row by row from the top, in place of "series".
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace foresight {

/// A mark or a series as above; which lists are used follows from `kind`.
struct PlotSeries {
  std::string name;
  const char* kind = "line";
  std::vector<double> x, y;                    ///< line, dots; x of area
  std::vector<double> left, right, low, high;  ///< bars; low and high of area
};
struct PlotMark {
  const char* axis = "x";
  double at = 0;
  std::string text;
};
struct PlotAxis {
  std::string unit;
  double least = 0, most = 1;
};

/// One of "plots".
std::string plot_json(const std::string& title, const PlotAxis& x, const PlotAxis& y,
                      std::span<const PlotSeries> series, std::span<const PlotMark> marks);
/// One of "plots": `cells` row by row, `columns` of them in a row.
std::string map_json(const std::string& title, const std::string& unit, std::span<const double> cells,
                     std::size_t columns, int width_px, int height_px);
/// The whole file.
std::string plot_file_json(const std::string& title, std::span<const std::string> plots);

/// "report.html.plots.json" of "report.html"; nothing where `page` is a pipe or a device, which has no place beside it.
std::optional<std::filesystem::path> plot_data_file(const std::filesystem::path& page);
/// Writes a page and its plots' data, both or none. Throws RuntimeFailure like write_files_atomically.
void write_page(const std::filesystem::path& page, const std::string& html, const std::string& title,
                std::span<const std::string> plots);

}  // namespace foresight
