#include "common/plot_data.hpp"

#include <nlohmann/json.hpp>
#include <string_view>

#include "common/atomic_file.hpp"

namespace foresight {
namespace {

using Json = nlohmann::ordered_json;

// Names come from outside; what is no UTF-8 in them must not cost the file.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json axis_json(const PlotAxis& axis) {
  return {{"unit", axis.unit}, {"range", {axis.least, axis.most}}};
}

Json series_json(const PlotSeries& series) {
  Json out = {{"name", series.name}, {"kind", series.kind}};
  const std::string_view kind = series.kind;
  if (kind == "bars") {
    out["left"] = series.left;
    out["right"] = series.right;
  } else {
    out["x"] = series.x;
  }
  if (kind == "area" || kind == "bars") {
    out["low"] = series.low;
    out["high"] = series.high;
  } else {
    out["y"] = series.y;
  }
  return out;
}

}  // namespace

std::string plot_json(const std::string& title, const PlotAxis& x, const PlotAxis& y,
                      std::span<const PlotSeries> series, std::span<const PlotMark> marks) {
  Json out = {{"title", title}, {"x", axis_json(x)}, {"y", axis_json(y)}, {"series", Json::array()}};
  for (const PlotSeries& one : series) out["series"].push_back(series_json(one));
  if (!marks.empty()) out["marks"] = Json::array();
  for (const PlotMark& mark : marks)
    out["marks"].push_back({{"axis", mark.axis}, {"at", mark.at}, {"text", mark.text}});
  return dumped(out);
}

std::string map_json(const std::string& title, const std::string& unit, std::span<const double> cells,
                     std::size_t columns, int width_px, int height_px) {
  Json rows = Json::array();
  for (std::size_t i = 0; i + columns <= cells.size(); i += columns)
    rows.push_back(std::vector<double>(cells.begin() + static_cast<std::ptrdiff_t>(i),
                                       cells.begin() + static_cast<std::ptrdiff_t>(i + columns)));
  return dumped({{"title", title}, {"unit", unit}, {"size_px", {width_px, height_px}}, {"cells", std::move(rows)}});
}

std::string plot_file_json(const std::string& title, std::span<const std::string> plots) {
  std::string out = "{\"generator\":\"foresight\",\"title\":" + dumped(title) + ",\"plots\":[";
  for (std::size_t i = 0; i < plots.size(); ++i) out += (i ? ",\n" : "\n") + plots[i];
  return out + "\n]}\n";
}

std::optional<std::filesystem::path> plot_data_file(const std::filesystem::path& page) {
  std::error_code ignored;
  const auto status = std::filesystem::status(page, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return std::nullopt;
  return std::filesystem::path(page) += ".plots.json";
}

void write_page(const std::filesystem::path& page, const std::string& html, const std::string& title,
                std::span<const std::string> plots) {
  const auto beside = plots.empty() ? std::nullopt : plot_data_file(page);
  if (!beside) return write_file_atomically(page, html);
  const std::string data = plot_file_json(title, plots);
  const FileContent files[] = {{page, html}, {*beside, data}};
  write_files_atomically(files);
}

}  // namespace foresight
