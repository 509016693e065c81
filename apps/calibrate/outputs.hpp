// What every `foresight calibrate` command may write: numbers, a result file, a report.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/command_line/command_line.hpp"
#include "calibration/result/result_file.hpp"

namespace foresight {

struct CalibrateOutputs {
  std::optional<std::filesystem::path> json;    ///< all numbers
  std::optional<std::filesystem::path> out;     ///< result file (calibration/result/result_file.hpp)
  std::optional<std::filesystem::path> report;  ///< self-contained HTML page
  bool force = false;                           ///< replaces a better result
};

/// --json, --out, --report, --force. `out`: what --out writes, where that is no result file.
void add_outputs(Command& command, CalibrateOutputs& outputs, OutputsOf out = {});

/// Writes to `file` where there is one; throws RuntimeFailure where it cannot be written.
void write_json(const std::optional<std::filesystem::path>& file, const nlohmann::ordered_json& numbers);

}  // namespace foresight
