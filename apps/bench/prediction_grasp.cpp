#include "apps/bench/prediction_grasp.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/grasp_trial.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

nlohmann::json report(const GraspTrialFigures& f, const GraspTrialOptions& options) {
  const auto p95_mm = [](const std::vector<double>& metres) { return 1e3 * quantile(metres, 0.95); };
  std::vector<double> both = f.carried;
  both.insert(both.end(), f.rest.begin(), f.rest.end());
  const double slowest = f.lateness.empty() ? 0 : *std::ranges::max_element(f.lateness);
  return {{"object_p95_mm", p95_mm(both)},
          {"object_carried_p95_mm", p95_mm(f.carried)},
          {"object_rest_p95_mm", p95_mm(f.rest)},
          {"object_unseen_p95_mm", p95_mm(f.unseen)},
          {"failed_grasps", f.failed},
          {"failed_grasps_noticed", f.noticed},
          {"failed_grasps_never_off", f.never_off},
          {"failed_grasps_not_noticed", f.failed - f.never_off - static_cast<int>(f.lateness.size())},
          {"noticed_slowest_ms", 1e3 * slowest},
          {"false_alarms", f.false_alarms},
          {"runs", f.runs},
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
  trial.runs = options.runs;
  trial.delay = 1e-3 * options.delay_ms;
  trial.seed = options.seed;
  const GraspTrialFigures figures = try_grasps(rig, trial);
  const nlohmann::json all = report(figures, trial);
  print(all);
  write_numbers(options.json, all.dump(2));
  return figures.carried.empty() || figures.noticed < figures.failed ? 1 : 0;
}

}  // namespace foresight
