#include "apps/bench/prediction_head.hpp"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/pose_table.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "prediction/arm_chain.hpp"
#include "prediction/pose_predictor.hpp"

namespace foresight {
namespace {

constexpr Duration kWindow{50'000'000};
constexpr std::size_t kFewestHeadPoses = 30;

struct Method {
  const char* name;
  const char* key;
  std::vector<double> way{}, turn{};  // errors, m and rad

  void score(const Pose& guess, const Pose& truth) {
    const Vector6 off = pose_difference(guess, truth);
    way.push_back(off.head<3>().norm());
    turn.push_back(off.tail<3>().norm());
  }
  void report(nlohmann::json& all) const {
    constexpr double kDegree = 180 / 3.14159265358979323846;
    const double way_p95 = quantile(way, 0.95) * 1e3, turn_p95 = quantile(turn, 0.95) * kDegree;
    const double way_rms = root_mean_square(way) * 1e3, turn_rms = root_mean_square(turn) * kDegree;
    std::printf("%-32s %9.2f mm %9.2f mm %9.3f deg %9.3f deg\n", name, way_p95, way_rms, turn_p95, turn_rms);
    const std::string before = key;
    all[before + "p95_mm"] = way_p95;
    all[before + "rms_mm"] = way_rms;
    all[before + "p95_deg"] = turn_p95;
    all[before + "rms_deg"] = turn_rms;
  }
};

// `now`, gone on for `ahead` as it came from `before` in `seconds`.
Pose gone_on(const Pose& before, const Pose& now, double seconds, double ahead) {
  return pose_between(now, pose_between(before, now, 2), ahead / seconds);
}

struct Counts {
  std::size_t rows = 0, lost = 0, anew = 0, inside = 0, turns_inside = 0;
  double cpu_seconds = 0;
};

void print_and_write(const PredictionHeadOptions& options, const std::array<Method, 4>& methods, const Counts& counts,
                     std::size_t repeated) {
  const std::size_t scored = methods[0].way.size();
  const double inside = static_cast<double>(counts.inside) / static_cast<double>(scored);
  const double turns_inside = static_cast<double>(counts.turns_inside) / static_cast<double>(scored);
  const double mean_us = counts.cpu_seconds * 1e6 / static_cast<double>(counts.rows);
  std::printf("%s: %zu rows, %zu lost, %zu times anew; %zu instants judged, %g ms ahead\n\n", options.csv.c_str(),
              counts.rows, counts.lost, counts.anew, scored, options.ahead_ms);
  std::printf("%-32s %12s %12s %13s %13s\n", "error", "p95", "rms", "p95", "rms");
  nlohmann::json all;
  for (const Method& method : methods) method.report(all);
  std::printf("\ntruth within 2 sigma: %.1f %% (position), %.1f %% (rotation); %.1f us a row\n", inside * 100,
              turns_inside * 100, mean_us);
  all["ahead_ms"] = options.ahead_ms;
  all["inside_2_sigma"] = inside;
  all["rotation_inside_2_sigma"] = turns_inside;
  all["scored"] = scored;
  all["rows"] = counts.rows;
  all["lost"] = counts.lost;
  all["anew"] = counts.anew;
  all["repeated"] = repeated;
  all["mean_us"] = mean_us;
  write_numbers(options.json, all.dump(2));
}

}  // namespace

int bench_prediction_head(const PredictionHeadOptions& options) {
  const PoseTable table = read_pose_table(options.csv);
  const PoseSeries& head = head_of(table);
  const PoseTrack track = head_track(table);
  PosePredictorOptions predictor_options;
  predictor_options.ahead = options.ahead_ms * 1e-3;
  PosePredictor predictor(predictor_options);
  const Duration ahead = seconds(predictor_options.ahead);
  const auto recorded = [&](std::int64_t ns) { return track.at(RobotTime{ns}, Duration{0}); };

  std::array methods{Method{"predicted", ""}, Method{"constant velocity over 50 ms", "constant_velocity_50ms_"},
                     Method{"newest two", "newest_two_"}, Method{"hold", "hold_"}};
  Counts counts;
  std::optional<std::size_t> last;  // row with a pose
  for (std::size_t i = 0; i < head.poses.size(); ++i) {
    ++counts.rows;
    if (!head.poses[i]) {
      ++counts.lost;
      continue;
    }
    const Pose& now = *head.poses[i];
    const std::int64_t ns = table.time_ns[i];
    const double from = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    const PoseTaken taken = predictor.observe({ns}, now);
    const PosePrediction predicted = predictor.at(OperatorTime{ns} + ahead);
    counts.cpu_seconds += cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - from;
    counts.anew += taken == PoseTaken::anew;
    const auto truth = recorded(ns + ahead.count()), before = recorded(ns - kWindow.count());
    if (last && truth.status != StateStatus::invalid && before.status != StateStatus::invalid) {
      const double step = to_seconds(Duration{ns - table.time_ns[*last]}), far = predictor_options.ahead;
      methods[0].score(predicted.pose, truth.pose);
      methods[1].score(gone_on(before.pose, now, to_seconds(kWindow), far), truth.pose);
      methods[2].score(gone_on(*head.poses[*last], now, step, far), truth.pose);
      methods[3].score(now, truth.pose);
      counts.inside += methods[0].way.back() <= 2 * predicted.position_sigma;
      counts.turns_inside += methods[0].turn.back() <= 2 * predicted.rotation_sigma;
    }
    last = i;
  }
  if (methods[0].way.size() < kFewestHeadPoses)
    throw InputError(options.csv.string(),
                     "has only " + std::to_string(methods[0].way.size()) + " poses whose future it shows" +
                         (counts.lost > 0 ? "; " + std::to_string(counts.lost) + " of its " +
                                                std::to_string(counts.rows) + " rows hold no rigid pose"
                                          : ""),
                     "name a recording of some seconds, with a pose at least every 200 ms");
  print_and_write(options, methods, counts, table.repeated);
  return 0;
}

}  // namespace foresight
