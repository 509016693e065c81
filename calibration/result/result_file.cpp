#include "calibration/result/result_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr const char* kUsable = "usable";
constexpr double kNoise = 1.02;  // two runs over other views of the same rig differ by about this factor

ViewPrints read_views(const YamlMap& top) {
  const std::vector<double> numbers = top.numbers("views");
  if (numbers.size() % 4 != 0)
    throw InputError(top.where("views"), "is no list of rows of 4 numbers", "write each as [points, u, v, spread]");
  ViewPrints views;
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    ViewPrint print;
    print.points = static_cast<int>(std::clamp(numbers[i], 0.0, 1e9));
    print.centre_px = {numbers[i + 1], numbers[i + 2]};
    print.spread_px = numbers[i + 3];
    views.push_back(print);
  }
  return views;
}

ResultHeader read_header(const YamlMap& top) {
  if (!top.has("kind"))
    throw InputError(top.where("kind"), "this is no result of a calibration", "give a file of `foresight calibrate`");
  top.require_known({"kind", "date", "devices", "score", "sigma", "verdict", "views", "result"});
  ResultHeader header;
  header.kind = top.text("kind");
  header.date = top.text("date");
  if (top.has("devices")) {
    const YamlMap devices = top.map("devices");
    for (const std::string& role : devices.keys()) header.devices[role] = devices.text(role);
  }
  const YamlMap score = top.map("score");
  score.require_known({"name", "value"});
  header.score_name = score.text("name");
  header.score = score.number("value");
  if (top.has("sigma")) {
    const YamlMap sigma = top.map("sigma");
    for (const std::string& name : sigma.keys()) header.sigma[name] = sigma.number(name);
  }
  if (top.has("verdict")) header.judged = top.choice<bool>("verdict", {{kUsable, true}});
  if (top.has("views")) header.views = read_views(top);
  return header;
}

void require_better(const std::filesystem::path& file, const ResultHeader& header) {
  if (!std::filesystem::exists(file)) return;
  const auto refuse = [&](const std::string& what) {
    throw InputError(file.string(), what, "write to another file, or give --force to replace it");
  };
  ResultHeader old;
  try {
    old = read_header(YamlMap::load(file));
  } catch (const InputError&) {
    refuse("it exists and is no calibration result");
  }
  if (old.kind != header.kind) refuse("it holds a result of kind " + in_quotes(old.kind) + ", not " + header.kind);
  for (const auto& [role, serial] : old.devices)
    if (const auto now = header.devices.find(role); now != header.devices.end() && now->second != serial)
      refuse("it belongs to the " + role + " device " + in_quotes(serial) + ", not " + in_quotes(now->second));
  if (old.judged && !header.judged) refuse("its solver judged it to be usable, and nobody judged the new one");
  if (old.judged == header.judged && old.score_name == header.score_name && header.score > kNoise * old.score)
    refuse(fmt::format("its {} of {:.4g} is better than the new {:.4g}", old.score_name, old.score, header.score));
}

YAML::Node to_yaml(const ResultHeader& header, const YAML::Node& result) {
  YAML::Node top;
  top["kind"] = header.kind;
  top["date"] = header.date;
  for (const auto& [role, serial] : header.devices) top["devices"][role] = serial;
  top["score"]["name"] = header.score_name;
  top["score"]["value"] = header.score;
  for (const auto& [name, sigma] : header.sigma) top["sigma"][name] = sigma;
  if (header.judged) top["verdict"] = kUsable;
  for (const ViewPrint& view : header.views) {
    YAML::Node row(YAML::NodeType::Sequence);
    row.SetStyle(YAML::EmitterStyle::Flow);
    row.push_back(view.points);
    for (const double px : {view.centre_px.x(), view.centre_px.y(), view.spread_px}) row.push_back(readable(px, 3));
    top["views"].push_back(row);
  }
  top["result"] = result;
  return top;
}

}  // namespace

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

void write_result(const std::filesystem::path& file, const ResultHeader& header, const YAML::Node& result, bool force) {
  if (!force) require_better(file, header);
  YAML::Emitter text;
  text.SetDoublePrecision(17);
  text << to_yaml(header, result);
  write_file_atomically(file, std::string(text.c_str()) + "\n");
}

ResultFile read_result(const std::filesystem::path& file, const std::string& kind) {
  const YamlMap top = YamlMap::load(file);
  ResultHeader header = read_header(top);
  if (header.kind != kind)
    throw InputError(top.where("kind"), "this is a result of kind " + in_quotes(header.kind),
                     "give one of `foresight calibrate " + kind + "`");
  return {std::move(header), top.map("result")};
}

}  // namespace foresight
