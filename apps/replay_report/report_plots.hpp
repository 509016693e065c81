// The plots of the HTML report, each as HTML (legend and inline SVG) with its title.
#pragma once

#include <string>
#include <vector>

#include "apps/replay_report/replay_report.hpp"

namespace foresight {

struct ReportPlot {
  std::string title;
  std::string body;  ///< HTML
  std::string data;  ///< JSON (common/plot_data.hpp)
};

/// Long runs are averaged into at most kPlotColumns columns.
inline constexpr std::size_t kPlotColumns = 160;
std::vector<ReportPlot> plots_of(const RunRecord& run, const Summary& summary);

}  // namespace foresight
