// What commands that show views leave behind: pictures, a report for programs and one for people.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "apps/command_line/command_line.hpp"
#include "apps/replay_report/instants.hpp"
#include "apps/replay_report/replay_report.hpp"

namespace foresight {

struct ViewOutputs {
  std::optional<std::filesystem::path> out;     ///< folder for predicted/*.png and contact_sheet.png
  std::optional<std::filesystem::path> report;  ///< JSON file
  std::optional<std::filesystem::path> html;    ///< HTML file
  bool any() const { return out || report || html; }
};

/// Adds --out, --report and --html. `outputs` must live as long as `command`.
void add_view_outputs(Command& command, ViewOutputs& outputs);

/// Refuses outputs that cannot be written, that are each other, or that are one of `inputs` (output_files.hpp).
/// `pictures`: names of those that are known already. Throws InputError naming the option, the path, the reason and
/// the cure.
void check_outputs(const ViewOutputs& outputs, const std::set<std::filesystem::path>& inputs,
                   std::span<const std::string> pictures);

/// Writes all but the predicted pictures: `title` is the contact sheet's. Throws RuntimeFailure.
void write_reports(const ViewOutputs& outputs, const RunRecord& record, std::span<const Instant> instants,
                   const std::string& title);

}  // namespace foresight
