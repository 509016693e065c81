// The report for people: one HTML file with everything in it, for any browser, light or dark.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "apps/replay_report/instants.hpp"
#include "apps/replay_report/replay_report.hpp"

namespace foresight {

/// The page. It asks no server for anything; pictures are JPEGs inside the file. All text is escaped.
std::string render_html_report(const RunRecord& run, std::span<const Instant> instants);

/// Renders and writes the page, and the series of its plots beside it (common/plot_data.hpp), both or none. Throws
/// RuntimeFailure naming `file` and the cure.
void write_html_report(const RunRecord& run, std::span<const Instant> instants, const std::filesystem::path& file);

}  // namespace foresight
