#include "apps/bench/prediction_robot.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/robot_trial.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr double kDegree = 0.017453292519943295;

DirectionSpec direction(const PredictionRobotOptions& options) {
  DirectionSpec out;
  out.delay = seconds(options.delay_ms * 1e-3);
  out.jitter = seconds(options.jitter_ms * 1e-3);
  out.reorder = true;
  out.loss = options.loss;
  return out;
}

double share_of(std::size_t part, std::size_t all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0;
}

// Of those of which something was learnt.
nlohmann::json drives(const RobotTrialFigures& figures, const Rig& rig) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    if (const ResponseFigures& drive = figures.drives[i]; drive.samples > 0)
      out.push_back({{"joint", rig.joints[i].drive.name},
                     {"dead_time_s", drive.dead_time},
                     {"lag_s", drive.lag},
                     {"sigma_s", drive.delay_sigma},
                     {"explained", drive.explained}});
  return out;
}

nlohmann::json report(const RobotTrialFigures& f, const Rig& rig, const PredictionRobotOptions& options) {
  const auto p95_mm = [](const std::vector<double>& metres) { return 1e3 * quantile(metres, 0.95); };
  const std::vector<double>& tool = f.predicted.tool;
  return {{"delay_ms", options.delay_ms},
          {"jitter_ms", options.jitter_ms},
          {"loss", options.loss},
          {"tool_p95_mm", p95_mm(tool)},
          {"tool_rms_mm", 1e3 * root_mean_square(tool)},
          {"tool_worst_mm", 1e3 * *std::max_element(tool.begin(), tool.end())},
          {"tool_p95_deg", quantile(f.rotation, 0.95) / kDegree},
          {"tool_sigma_median_mm", 1e3 * median(f.tool_sigma)},
          {"tool_inside_2_sigma", share_of(f.tool_inside, tool.size())},
          {"joints_inside_2_sigma", share_of(f.joints_inside, f.joints_judged)},
          {"joint_p95_rad", quantile(f.joints, 0.95)},
          {"pixel_p95_px", quantile(f.pixels, 0.95)},
          {"shaft_tool_p95_mm", p95_mm(f.shafts)},
          {"hold_tool_p95_mm", p95_mm(f.hold.tool)},
          {"velocity_tool_p95_mm", p95_mm(f.velocity.tool)},
          {"asked_tool_p95_mm", p95_mm(f.asked.tool)},
          {"held_tool_p95_mm", f.held.empty() ? nlohmann::json() : nlohmann::json(p95_mm(f.held))},
          {"held", f.held.size()},
          {"pictures", f.pictures},
          {"judged", tool.size()},
          {"invalid", share_of(f.invalid, f.pictures)},
          {"invalid_words", f.invalid_words},
          {"largest_step_over_limit", f.largest_step_share},
          {"delay_ms_told", 1e3 * f.delay_s},
          {"delay_ms_sigma", 1e3 * f.delay_sigma_s},
          {"cpu_share", f.cpu_s / f.time_s},
          {"moved_rad", f.moved_rad},
          {"fastest_share", f.fastest_share},
          {"drives", drives(f, rig)}};
}

void print_robot(const nlohmann::json& all) {
  const auto number = [&](const char* key) { return all[key].is_number() ? all[key].get<double>() : 0.0; };
  std::printf("tool, 95 %% of %.0f pictures are nearer, %.0f ms and 0 to %.0f ms more each way, %.1f %% lost\n",
              number("judged"), number("delay_ms"), number("jitter_ms"), 100 * number("loss"));
  std::printf("  %-36s %8.2f mm, %.2f deg, %.2f px; by the shafts %.2f mm\n", "predicted", number("tool_p95_mm"),
              number("tool_p95_deg"), number("pixel_p95_px"), number("shaft_tool_p95_mm"));
  std::printf("  %-36s %8.2f mm\n", "joints that are asked for", number("asked_tool_p95_mm"));
  std::printf("  %-36s %8.2f mm\n", "last state at its velocity", number("velocity_tool_p95_mm"));
  std::printf("  %-36s %8.2f mm\n", "last state", number("hold_tool_p95_mm"));
  std::printf("truth within 2 sigma: tool %.1f %%, joints %.1f %%; sigma of the tool %.2f mm (median)\n",
              100 * number("tool_inside_2_sigma"), 100 * number("joints_inside_2_sigma"),
              number("tool_sigma_median_mm"));
  std::printf("invalid %.1f %% %s; largest step %.2f of what joints may; %.1f %% of a core; fastest joint at %.2f\n",
              100 * number("invalid"), all["invalid_words"].get<std::string>().c_str(),
              number("largest_step_over_limit"), 100 * number("cpu_share"), number("fastest_share"));
  if (number("held") > 0)
    std::printf("while the gate held the robot back, %.0f pictures: %.2f mm\n", number("held"),
                number("held_tool_p95_mm"));
}

void print_drives(const RobotTrialFigures& figures, const Rig& rig) {
  std::printf("how the drives follow, for the joints' lines of the rig file:\n");
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    if (figures.drives[i].samples > 0)
      std::printf("  %-16s %s\n", rig.joints[i].drive.name.c_str(), to_rig_key(figures.drives[i]).c_str());
}

}  // namespace

int bench_prediction_robot(const PredictionRobotOptions& options) {
  const Rig rig = read_rig(options.rig);
  RobotTrialOptions trial;
  trial.line.up = trial.line.down = direction(options);
  trial.line.seed = options.seed;
  trial.seconds = options.seconds;
  trial.seed = options.seed;
  const RobotTrialFigures figures = try_robot(rig, trial);
  if (figures.predicted.tool.empty()) {
    std::fprintf(stderr, "nothing could be judged: %s\n", figures.invalid_words.c_str());
    return 1;
  }
  const nlohmann::json all = report(figures, rig, options);
  print_robot(all);
  print_drives(figures, rig);
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
