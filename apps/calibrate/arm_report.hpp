// Numbers and page of a hand-eye calibration.
#pragma once

#include <nlohmann/json.hpp>

#include "calibration/result/html_report.hpp"
#include "calibration/robot/robot_results.hpp"

namespace foresight {

nlohmann::ordered_json arm_numbers(const HandEyeSummary& summary, const ArmNames& names,
                                   const std::optional<Pose>& T_head_base);
HtmlReport arm_report(const HandEyeSummary& summary, const ArmNames& names);

}  // namespace foresight
