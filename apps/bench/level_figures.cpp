#include "apps/bench/level_figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/head_lab.hpp"
#include "apps/bench/level_lab.hpp"
#include "apps/view_outputs.hpp"
#include "common/cpu_time.hpp"
#include "common/statistics.hpp"
#include "pictures/picture_file.hpp"
#include "scene/lod/motion_levels.hpp"
#include "sim/building.hpp"
#include "sim/workshop.hpp"

namespace foresight {
namespace {

constexpr int kTransitionFrames = 12;
constexpr double kFrameEvery = 0.1;                // s
constexpr double kBudgets[] = {30, 60, 120, 240};  // ms
constexpr double kMiddleBudget = 120;
constexpr double kGoodDb = 30;

Lens level_lens(int width, int height) {
  Lens::Parameters p;
  p.width = width;
  p.height = height;
  p.fx = p.fy = 0.8 * width;
  p.cx = (width - 1) / 2.0;
  p.cy = (height - 1) / 2.0;
  return Lens(p);
}

/// Looks along x, upright.
Pose along_x(const Eigen::Vector3d& from) {
  Pose out = Pose::Identity();
  out.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  out.translation() = from;
  return out;
}

/// The head's motion since the beginning, in a camera's axes; at most so many frames of it.
std::vector<Pose> motions(const PoseTrack& head, int frames) {
  std::vector<Pose> out;
  std::optional<Pose> first;
  const RobotTime begin = head.samples().front().time;
  for (int i = 0; i < frames; ++i) {
    const auto at = head.at(begin + seconds(kFrameEvery * i));
    if (at.status == StateStatus::invalid) continue;
    if (!first) first = at.pose;
    out.push_back(in_camera_axes(first->inverse() * at.pose));
  }
  return out;
}

/// A scene and the frames of a head in it, with their pictures in full.
struct LevelScene {
  const char* name;
  SceneModel model;
  std::vector<HeadInScene> path;
  std::unique_ptr<LevelLab> lab;
  std::vector<LevelFrame> full;
};

struct RuleFigures {
  std::vector<double> cpu_ms, db, triangles;
  LevelCounts counts;
};

RuleFigures along_path(LevelScene& scene, const LevelSettings& settings) {
  LevelDirector director(scene.lab->levels(), settings);
  RuleFigures out;
  for (std::size_t i = 0; i < scene.path.size(); ++i) {
    const LevelFrame frame = scene.lab->draw(scene.path[i], director);
    out.cpu_ms.push_back(frame.cpu_ms);
    out.triangles.push_back(director.last().work.triangles);
    out.db.push_back(picture_decibels(frame.picture, scene.full[i].picture));
  }
  out.counts = director.counts();
  return out;
}

nlohmann::json report(const char* words, const RuleFigures& f, double budget_ms) {
  const auto share = [](const std::vector<double>& all, auto&& holds) {
    return static_cast<double>(std::ranges::count_if(all, holds)) / static_cast<double>(all.size());
  };
  const double within = share(f.cpu_ms, [&](double ms) { return ms <= budget_ms; });
  const double good = share(f.db, [](double db) { return db >= kGoodDb; });
  std::printf(
      "  %-34s %6.1f CPU-ms, p95 %6.1f; within the budget %5.1f %%; %5.1f dB (worst %.1f, 30 or more in %5.1f %%); "
      "%8.0f "
      "triangles; %5llu changes, %4llu back, %4llu cut short\n",
      words, median(f.cpu_ms), quantile(f.cpu_ms, 0.95), 100 * within, median(f.db), *std::ranges::min_element(f.db),
      100 * good, median(f.triangles), static_cast<unsigned long long>(f.counts.changes),
      static_cast<unsigned long long>(f.counts.reversals), static_cast<unsigned long long>(f.counts.cut_short));
  nlohmann::json out{{"cpu_ms", median(f.cpu_ms)},
                     {"p95_cpu_ms", quantile(f.cpu_ms, 0.95)},
                     {"db", {{"median", median(f.db)}, {"worst", *std::ranges::min_element(f.db)}}},
                     {"share_30_db", good},
                     {"triangles", median(f.triangles)},
                     {"changes", f.counts.changes},
                     {"reversals", f.counts.reversals},
                     {"cut_short", f.counts.cut_short}};
  if (std::isfinite(budget_ms)) out["within_budget"] = within;
  return out;
}

nlohmann::json budget_figures(LevelScene& scene) {
  nlohmann::json out = nlohmann::json::array();
  for (const double budget : kBudgets)
    for (const LevelRule rule : {LevelRule::predictive, LevelRule::reactive})
      for (const double hysteresis : {LevelSettings{}.hysteresis, 0.0}) {
        if (hysteresis == 0 && budget != kMiddleBudget) continue;
        const char* const name = rule == LevelRule::predictive ? "predictive" : "reactive";
        char words[80];
        std::snprintf(words, sizeof words, "%.0f ms, %s%s", budget, name, hysteresis > 0 ? "" : ", no hysteresis");
        nlohmann::json row =
            report(words, along_path(scene, {.rule = rule, .hysteresis = hysteresis, .budget_ms = budget}), budget);
        row["budget_ms"] = budget;
        row["rule"] = name;
        row["hysteresis"] = hysteresis;
        out.push_back(row);
      }
  return out;
}

/// A head that stands still while all that it sees becomes coarser by a level: the largest jump from frame to frame.
nlohmann::json transition_figures(LevelScene& scene) {
  nlohmann::json out;
  const HeadInScene& head = scene.path.front();
  LevelDirector director(scene.lab->levels(), {.px = 2, .transition = LevelTransition::hard});
  scene.lab->draw(head, director);
  LevelPlan plan = director.last();
  const auto levels_of = [&](std::size_t node) { return scene.lab->levels()->nodes()[node].levels.size(); };
  for (const auto& [transition, name] :
       {std::pair(LevelTransition::hard, "hard"), std::pair(LevelTransition::geomorph, "geomorph"),
        std::pair(LevelTransition::fade, "fade")}) {
    plan.transition = transition;
    cv::Mat before;
    double most = 0;
    std::vector<double> cpu_ms;
    for (int i = 0; i <= kTransitionFrames; ++i) {
      LevelPlan now = plan;
      const double share = transition == LevelTransition::hard ? std::floor(2.0 * i / (kTransitionFrames + 1))
                                                               : static_cast<double>(i) / kTransitionFrames;
      for (std::size_t n = 0; n < now.blends.size(); ++n) {
        if (static_cast<std::size_t>(now.blends[n].level) + 1 >= levels_of(n)) continue;
        if (share >= 1)
          ++now.blends[n].level;
        else
          now.blends[n].share = static_cast<float>(share);
      }
      const LevelFrame frame = scene.lab->draw(head, now);
      if (!before.empty()) most = std::max(most, largest_jump(before, frame.picture));
      before = frame.picture;
      cpu_ms.push_back(frame.cpu_ms);
    }
    std::printf("  %-34s largest jump from frame to frame %5.1f grey levels (16 x 16 px); %.1f CPU-ms\n", name, most,
                median(cpu_ms));
    out[name] = {{"largest_jump", most}, {"cpu_ms", median(cpu_ms)}};
  }
  return out;
}

nlohmann::json motion_figures(const LevelScene& scene, const Lens& lens) {
  nlohmann::json out;
  for (const double px : {0.5, 2.0}) {
    MotionLevels levels(scene.lab->levels()->boxes(), {.px = px});
    for (const HeadInScene& head : scene.path) levels.shown(head.state, {head.T_world_camera, lens.parameters().fx});
    const MotionLevels::Counts& counts = levels.counts();
    if (counts.moved == 0) return out;
    const double share = static_cast<double>(counts.shown) / static_cast<double>(counts.moved);
    std::printf("  things that moved, moved in the picture when off by %.1f px: %.1f %% of %llu times\n", px,
                100 * share, static_cast<unsigned long long>(counts.moved));
    out.push_back({{"px", px}, {"moved", counts.moved}, {"shown", counts.shown}});
  }
  return out;
}

/// In full, within 120 ms, and its levels beside each other, once selection has learnt.
void write_picture(LevelScene& scene, const std::filesystem::path& file) {
  const std::size_t last = std::min<std::size_t>(30, scene.path.size() - 1);
  LevelDirector director(scene.lab->levels(), {.rule = LevelRule::predictive, .budget_ms = kMiddleBudget});
  cv::Mat within;
  for (std::size_t i = 0; i <= last; ++i) within = scene.lab->draw(scene.path[i], director).picture;
  cv::Mat all;
  cv::hconcat(std::vector<cv::Mat>{scene.full[last].picture, within, scene.lab->levels_seen(director.last())}, all);
  write_png(file, all);
}

nlohmann::json scene_figures(LevelScene& scene, const Lens& lens) {
  const double before = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const auto levels = std::make_shared<const SceneLevels>(scene.model);
  const double built_s = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
  scene.lab = std::make_unique<LevelLab>(scene.model, levels, lens, gl::LeavesOut::out_of_view);
  std::vector<double> full_ms;
  for (const HeadInScene& head : scene.path) {
    scene.full.push_back(scene.lab->draw_in_full(head));
    full_ms.push_back(scene.full.back().cpu_ms);
  }
  std::printf("%s of %zu triangles, %zu frames of %d x %d px; levels made in %.1f CPU-s, %zu things have none\n",
              scene.name, scene.model.triangle_count(), scene.path.size(), lens.width(), lens.height(), built_s,
              levels->remarks().size());
  std::printf("  %-34s %6.1f CPU-ms, p95 %6.1f\n", "in full", median(full_ms), quantile(full_ms, 0.95));
  nlohmann::json out{{"triangles", scene.model.triangle_count()},
                     {"frames", scene.path.size()},
                     {"levels_cpu_s", built_s},
                     {"without_levels", levels->remarks().size()},
                     {"full", {{"cpu_ms", median(full_ms)}, {"p95_cpu_ms", quantile(full_ms, 0.95)}}}};
  const double no_budget = std::numeric_limits<double>::infinity();
  out["by_size"] = report("by size, 1 px", along_path(scene, {.rule = LevelRule::by_size}), no_budget);
  out["by_acuity"] = report("by acuity, 1 px", along_path(scene, {.rule = LevelRule::by_acuity}), no_budget);
  out["budgets"] = budget_figures(scene);
  out["transitions"] = transition_figures(scene);
  out["motion"] = motion_figures(scene, lens);
  return out;
}

}  // namespace

nlohmann::json level_figures(const LevelTrial& trial, const PoseTrack& track) {
  const Lens lens = level_lens(trial.width, trial.height);
  const std::vector<Pose> head = motions(track, trial.frames);
  nlohmann::json out;
  {
    LevelScene scene{"a building", sim::make_building({.triangles = trial.triangles, .seed = trial.seed}), {}, {}, {}};
    for (std::size_t i = 0; i < head.size(); ++i)
      scene.path.push_back({along_x({7.5, 6, 1.5}) * head[i],
                            {{}, StateStatus::exact, scene.model.rest_poses()},
                            kFrameEvery * static_cast<double>(i)});
    out["building"] = scene_figures(scene, lens);
  }
  LevelScene scene{"a workshop", sim::make_workshop({.triangles = trial.triangles, .seed = trial.seed}), {}, {}, {}};
  for (std::size_t i = 0; i < head.size(); ++i) {
    const double seconds = kFrameEvery * static_cast<double>(i);
    scene.path.push_back({along_x({-10.5, 0, 1.6}) * head[i], sim::workshop_state(scene.model, seconds), seconds});
  }
  out["workshop"] = scene_figures(scene, lens);
  if (trial.picture) write_picture(scene, *trial.picture);
  return out;
}

}  // namespace foresight
