#include "apps/bench/prediction_operators.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/operator_trial.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

const char* accident_name(OperatorAccident accident) {
  constexpr const char* kNames[] = {"none", "slips", "moved"};
  return kNames[static_cast<std::size_t>(accident)];
}

nlohmann::ordered_json operator_row(const std::vector<OperatorRun>& runs, const OperatorTrialOptions& options) {
  std::vector<double> times;
  double moves = 0, regrasps = 0;
  for (const OperatorRun& run : runs) {
    if (run.succeeded) times.push_back(run.seconds);
    moves += run.moves;
    regrasps += run.regrasps;
  }
  const auto time = [&](double share) {
    return times.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(quantile(times, share));
  };
  const double count = std::max<double>(1, static_cast<double>(runs.size()));
  return {{"delay_ms", 1e3 * options.delay},
          {"accident", accident_name(options.accident)},
          {"sees", options.predicted ? "prediction" : "image"},
          {"task_s", time(0.5)},
          {"task_s_p95", time(0.95)},
          {"failed", static_cast<std::size_t>(options.runs) - times.size()},
          {"runs", options.runs},
          {"moves", moves / count},
          {"regrasps", regrasps / count}};
}

void print_operators(const nlohmann::ordered_json& row) {
  const std::string time = row["task_s"].is_null() ? "-" : fmt::format("{:.1f}", row["task_s"].get<double>());
  fmt::print("{:6.0f} ms  {:6}  {:10}  {:>6} s  {:2} of {} failed  {:5.1f} moves  {:4.1f} times again\n",
             row["delay_ms"].get<double>(), row["accident"].get<std::string>(), row["sees"].get<std::string>(), time,
             row["failed"].get<int>(), row["runs"].get<int>(), row["moves"].get<double>(),
             row["regrasps"].get<double>());
  std::fflush(stdout);  // each takes a while
}

}  // namespace

int bench_prediction_operators(const PredictionOperatorsOptions& options) {
  const Rig rig = read_rig(options.rig);
  const std::vector<double> delays =
      options.delays_ms.empty() ? std::vector<double>{0, 100, 300, 500, 1000} : options.delays_ms;
  nlohmann::ordered_json all;
  all["simulated"] = true;
  all["seed"] = options.seed;
  all["trials"] = nlohmann::ordered_json::array();
  for (const double delay_ms : delays) {
    for (const auto accident : {OperatorAccident::none, OperatorAccident::slips, OperatorAccident::moved}) {
      if (!options.accident.empty() && options.accident != accident_name(accident)) continue;
      for (const bool predicted : {false, true}) {
        OperatorTrialOptions trial;
        trial.predicted = predicted;
        trial.delay = 1e-3 * delay_ms;
        trial.accident = accident;
        trial.runs = options.runs;
        trial.seed = options.seed;
        const auto row = operator_row(try_operator(rig, trial), trial);
        print_operators(row);
        all["trials"].push_back(row);
      }
    }
  }
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
