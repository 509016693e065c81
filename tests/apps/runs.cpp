#include "tests/apps/runs.hpp"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "common/read_file.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

// Made once per test program.
const fs::path& original(const std::string& option) {
  static const TempFolder folder;
  static std::map<std::string, fs::path> made;
  fs::path& run = made[option];
  if (!run.empty()) return run;
  const fs::path out = folder / ("run" + option);
  std::vector<std::string> words{"synth", out, "--frames", "8", "--size", "96x72"};
  if (!option.empty()) words.push_back(option);
  const Outcome outcome = run_program(words);
  if (outcome.exit_code != 0) throw std::runtime_error("no synthetic run: " + outcome.err);
  return run = out;
}

// Lines with data, without the first word, which is the time.
std::vector<std::string> rows(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (!line.starts_with('#')) out.push_back(line.substr(line.find(' ') + 1));
  return out;
}

}  // namespace

SmallRun::SmallRun(const std::string& option) {
  fs::copy(original(option), path(), fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

void SmallRun::change_images(const std::function<cv::Mat(const cv::Mat&)>& change) const {
  for (const std::string& name : names_in(path() / "rgb")) {
    const std::string file = path() / "rgb" / name;
    cv::imwrite(file, change(cv::imread(file, cv::IMREAD_UNCHANGED)));
  }
}

void SmallRun::keep(const std::string& list, int count) const {
  std::istringstream stream(read(list));
  std::string kept;
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with('#') || count-- > 0) kept += line + "\n";
  write(list, kept);
}

LoopedRun::LoopedRun(int images, double interval_s) {
  const SmallRun run;
  for (const char* name : {"camera.yaml", "scene.yaml", "arm.urdf", "meshes"})
    fs::copy(run / name, path() / name, fs::copy_options::recursive);
  fs::create_directory(path() / "rgb");
  const auto files = rows(run.read("rgb.txt")), poses = rows(run.read("trajectory.txt")),
             tracks = rows(run.read("nodes.txt"));
  // All moving nodes at one instant follow each other.
  const auto first = [](const std::string& row) { return row.substr(0, row.find(' ')); };
  std::size_t movers = 1;
  while (movers < tracks.size() && first(tracks[movers]) != first(tracks[0])) ++movers;
  const int count = static_cast<int>(files.size());
  const std::size_t instants_per_image = (tracks.size() / movers - 1) / static_cast<std::size_t>(count - 1);
  std::string list, trajectory, nodes;
  for (int i = 0; i < images; ++i) {
    const int turn = i % (2 * count - 2);
    const auto source = static_cast<std::size_t>(turn < count ? turn : 2 * count - 2 - turn);
    const std::string time = fmt::format("{:.6f} ", i * interval_s), name = fmt::format("rgb/{:06}.png", i);
    fs::create_hard_link(run / files[source], path() / name);
    list += time + name + "\n";
    trajectory += time + poses[source] + "\n";
    for (std::size_t k = 0; k < movers; ++k) nodes += time + tracks[source * instants_per_image * movers + k] + "\n";
  }
  write("rgb.txt", list);
  write("trajectory.txt", trajectory);
  write("nodes.txt", nodes);
}

std::string small_rig(const std::string& name, const TempFolder& folder, const std::string& size, int rate_hz) {
  const fs::path configs = source_folder() / "configs";
  std::string text = read_file(configs / name);
  for (const auto& [what, instead] : {std::pair<std::string, std::string>{"[320, 240]", "[" + size + "]"},
                                      {"rate_hz: 10", "rate_hz: " + std::to_string(rate_hz)}})
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + instead.size()))
      text.replace(at, what.size(), instead);
  fs::copy_file(configs / "arm.urdf", folder / "arm.urdf", fs::copy_options::overwrite_existing);
  return folder.write(name, text).string();
}

nlohmann::json read_json(const fs::path& file) {
  std::ifstream stream(file);
  return nlohmann::json::parse(stream);
}

nlohmann::json without_times(nlohmann::json report) {
  if (report.is_structured()) {
    if (report.is_object())
      for (auto it = report.begin(); it != report.end();)
        it = it.key().find("_ms") != std::string::npos || it.key() == "images_per_core_second" ? report.erase(it)
                                                                                               : std::next(it);
    for (auto& value : report) value = without_times(value);
  }
  return report;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  if (!fs::exists(folder)) return names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace foresight
