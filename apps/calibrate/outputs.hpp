// What every `foresight calibrate` command may write: numbers, a result file, a report.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "apps/command_line/command_line.hpp"
#include "calibration/result/html_report.hpp"
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

/// What a solver found.
struct Deliverable {
  Verdict verdict;
  ResultHeader header;  ///< its date and `judged` are set by deliver()
  YAML::Node payload;   ///< of the result file
  std::function<HtmlReport()> report;
};

/// Prints the verdict, and writes what was asked for: `numbers` with the verdict among them, the report with the
/// verdict above all, and the result where it may be used. Returns the exit code: 0, or 1 where it may not be used.
int deliver(const Deliverable& found, nlohmann::ordered_json& numbers, const CalibrateOutputs& outputs);

/// Prints that so many of the views are those that the result was solved from.
void tell_seen(std::size_t seen, std::size_t all);

/// The same for `verify`: prints "pass on 12 views", or "FAIL on 12 views" and each objection, and writes `numbers`
/// with them to `json`. Returns 0 or 1.
int tell_verified(const Verdict& verdict, std::size_t views, nlohmann::ordered_json& numbers,
                  const std::optional<std::filesystem::path>& json);

}  // namespace foresight
