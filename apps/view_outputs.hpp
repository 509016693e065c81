// What commands that show views leave behind: pictures, a report for programs and one for people.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/command_line/command_line.hpp"
#include "apps/replay_report/instants.hpp"
#include "apps/replay_report/replay_report.hpp"

namespace foresight {

struct ViewOutputs {
  std::optional<std::filesystem::path> out;     ///< folder for predicted/*.png and contact_sheet.png
  std::optional<std::filesystem::path> report;  ///< JSON file
  std::optional<std::filesystem::path> html;    ///< HTML file
  bool any() const { return out || report || html; }
  bool pictures() const { return out || html; }  ///< of a few instants: contact sheet, HTML report
};

/// Adds --out, --report and --html. `outputs` must live as long as `command`; `folders`: of pictures, within --out.
void add_view_outputs(Command& command, ViewOutputs& outputs, const std::vector<std::string>& folders = {"predicted"});

/// Throws RuntimeFailure.
void make_folder(const std::filesystem::path& folder);

/// Writes all but the predicted pictures: `title` is the contact sheet's. Throws RuntimeFailure.
void write_reports(const ViewOutputs& outputs, const RunRecord& record, std::span<const Instant> instants,
                   const std::string& title);

}  // namespace foresight
