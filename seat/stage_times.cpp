#include "seat/stage_times.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <numeric>

namespace foresight {
namespace {

constexpr std::size_t kNamed = 3;  // stages that cost most

std::string ways(const StageTimes& times) {
  std::string out;
  const auto add = [&out](const std::optional<Duration>& took, const char* words) {
    if (!took) return;
    out += fmt::format("{}{} {:.0f} ms", out.empty() ? "" : ", ", words, 1e3 * to_seconds(*took));
  };
  const auto& [paired, registered, taken, coded, arrived, decoded] = times.ages;
  add(paired, "paired");
  add(registered, "posed");
  add(coded, "coded");
  add(arrived ? std::optional(arrived->delay) : std::nullopt, "here");
  if (decoded) {
    add(decoded->delay, "decoded");
    if (times.to_view) add(decoded->delay + *times.to_view, "seen");
  }
  if (!out.empty()) out = "an image's age: " + out;
  add(times.to_textures, "textures take");
  add(times.drawing, "drawing");
  add(times.to_set_point, "hand until sent");
  return out;
}

// On a software renderer the CPU is what counts; on a GPU, that.
std::string costs(std::vector<StageCost> stages) {
  if (stages.empty()) return "";
  const bool by_gpu = std::ranges::all_of(stages, [](const StageCost& stage) { return stage.gpu_ms.has_value(); });
  const auto cost = [by_gpu](const StageCost& stage) { return by_gpu ? *stage.gpu_ms : stage.cpu_ms; };
  const double sum = std::transform_reduce(stages.begin(), stages.end(), 0.0, std::plus(), cost);
  std::ranges::stable_sort(stages, std::greater(), cost);
  std::string out = fmt::format("an image {:.0f} ms of {}", sum, by_gpu ? "GPU" : "CPU");
  for (std::size_t i = 0; i < std::min(kNamed, stages.size()); ++i)
    out += fmt::format("{} {} {:.0f}", i == 0 ? ":" : ",", stages[i].name, cost(stages[i]));
  return out;
}

}  // namespace

std::vector<SeatLine> stage_lines(const StageTimes& times) {
  std::vector<SeatLine> out;
  if (std::string words = ways(times); !words.empty()) out.push_back({"times", std::move(words), ""});
  if (std::string words = costs(times.costs); !words.empty()) out.push_back({"costs", std::move(words), ""});
  return out;
}

void ImageWay::came(RobotTime captured, RobotTime decoded) {
  const bool is_another_clock = under_way_ && captured < under_way_->captured;
  if (!under_way_ || is_another_clock) under_way_ = {captured, decoded};
}

void ImageWay::drawn(RobotTime captured) {
  drawn_ = under_way_ && captured >= under_way_->captured;
}

void ImageWay::swapped(RobotTime now) {
  if (!under_way_ || !drawn_) return;
  to_view_ = now - under_way_->came;
  under_way_.reset();
  drawn_ = false;
}

}  // namespace foresight
