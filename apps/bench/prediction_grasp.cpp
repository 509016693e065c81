#include "apps/bench/prediction_grasp.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/grasp_trial.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr double kAllowed = 0.3 + 1e-6;  // s, beyond the delay; instants are rounded to ns, each by itself

/// Of all runs.
struct Noticed {
  int failed = 0, in_time = 0, never = 0;
  int never_off = 0;  // of those that failed: shown where it was all the time, so that nothing was there to notice
  int false_alarms = 0;
  double slowest = 0;                             // s
  nlohmann::json runs = nlohmann::json::array();  // those that failed, or in which it was put elsewhere
};

Noticed count(const std::vector<GraspRun>& runs) {
  Noticed out;
  const auto milliseconds = [](const std::optional<double>& s) {
    return s ? nlohmann::json(1e3 * *s) : nlohmann::json();
  };
  for (const GraspRun& run : runs) {
    if (!run.failed) out.false_alarms += run.before_visible;
    if (!run.failed && run.put_elsewhere == 0) continue;
    out.runs.push_back({{"run", run.number},
                        {"accident", run.accident},
                        {"failed", run.failed},
                        {"visible_ms", milliseconds(run.visible)},
                        {"noticed_ms", milliseconds(run.lateness)},
                        {"put_elsewhere", run.put_elsewhere},
                        {"before_visible", run.before_visible}});
    if (!run.failed) continue;
    ++out.failed;
    out.never_off += !run.visible;
    out.never += run.visible && !run.lateness;
    if (!run.lateness) continue;
    out.in_time += *run.lateness <= kAllowed;
    out.slowest = std::max(out.slowest, *run.lateness);
  }
  return out;
}

nlohmann::json report(const GraspTrialFigures& f, const GraspTrialOptions& options) {
  const auto p95_mm = [](const std::vector<double>& metres) { return 1e3 * quantile(metres, 0.95); };
  std::vector<double> both = f.carried;
  both.insert(both.end(), f.rest.begin(), f.rest.end());
  const Noticed noticed = count(f.runs);
  return {{"object_p95_mm", p95_mm(both)},
          {"object_carried_p95_mm", p95_mm(f.carried)},
          {"object_rest_p95_mm", p95_mm(f.rest)},
          {"object_unseen_p95_mm", p95_mm(f.unseen)},
          {"failed_grasps", noticed.failed},
          {"failed_grasps_noticed", noticed.in_time},
          {"failed_grasps_never_off", noticed.never_off},
          {"failed_grasps_not_noticed", noticed.never},
          {"noticed_slowest_ms", 1e3 * noticed.slowest},
          {"false_alarms", noticed.false_alarms},
          {"runs_that_failed", noticed.runs},
          {"first_run", options.first_run},
          {"runs", f.runs.size()},
          {"judged", both.size()},
          {"sighting_sigma_mm", 1e3 * options.sighting_sigma},
          {"sighting_hz", f.sighting_hz},
          {"delay_ms", 1e3 * options.delay}};
}

void print(const nlohmann::json& all) {
  const auto number = [&](const char* key) { return all[key].get<double>(); };
  std::printf("%.0f runs, %.0f ms each way, sightings %.1f mm at %.0f Hz\n", number("runs"), number("delay_ms"),
              number("sighting_sigma_mm"), number("sighting_hz"));
  std::printf("  brick, 95 %% of %.0f pictures are nearer  %8.2f mm\n", number("judged"), number("object_p95_mm"));
  std::printf("    while carried                          %8.2f mm\n", number("object_carried_p95_mm"));
  std::printf("    at rest, seen again                    %8.2f mm\n", number("object_rest_p95_mm"));
  std::printf("    at rest, not yet seen                  %8.2f mm\n", number("object_unseen_p95_mm"));
  std::printf("  failed grasps %.0f, noticed in time %.0f (slowest %.0f ms beyond the delay), false alarms %.0f\n",
              number("failed_grasps"), number("failed_grasps_noticed"), number("noticed_slowest_ms"),
              number("false_alarms"));
  std::printf("    never noticed %.0f, shown where they were all the time %.0f\n", number("failed_grasps_not_noticed"),
              number("failed_grasps_never_off"));
}

}  // namespace

int bench_prediction_grasp(const PredictionGraspOptions& options) {
  const Rig rig = read_rig(options.rig);
  GraspTrialOptions trial;
  trial.first_run = options.first_run;
  trial.runs = options.runs;
  trial.failing = options.failing;
  trial.delay = 1e-3 * options.delay_ms;
  trial.seed = options.seed;
  const GraspTrialFigures figures = try_grasps(rig, trial);
  const nlohmann::json all = report(figures, trial);
  print(all);
  write_numbers(options.json, all.dump(2));
  return figures.carried.empty() || all["failed_grasps_noticed"] < all["failed_grasps"] ? 1 : 0;
}

}  // namespace foresight
