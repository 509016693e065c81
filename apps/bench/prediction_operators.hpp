// `foresight bench prediction operators`: the same model operator with the newest image, and with the prediction.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace foresight {

struct PredictionOperatorsOptions {
  std::filesystem::path rig = "configs/minerva.yaml";  ///< whose robot is the mock lab's arm
  int runs = 10;                                       ///< each
  std::vector<double> delays_ms{};                     ///< each way; empty: 0, 100, 300, 500, 1,000
  std::string accident;                                ///< none, slips or moved; empty: each
  unsigned seed = 1;
  std::optional<std::filesystem::path> json;
};

/// Simulated (operator_trial.hpp): by no means what people would need. For each delay and each accident (none, slips,
/// moved), prints, and writes to `json` as rows of `trials`:
///   delay_ms, accident, sees            "image" or "prediction"
///   task_s, task_s_p95                  median and 95 % of the runs that succeeded; null where none did
///   failed, runs, moves, regrasps       moves, regrasps: means of all runs
/// The runs of all rows have the same bricks, trays, masses and friction, one by one. Throws as try_operator().
int bench_prediction_operators(const PredictionOperatorsOptions& options);

}  // namespace foresight
