// Numbers and page of a hand-eye calibration.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/calibrate/arm_input.hpp"
#include "calibration/result/html_report.hpp"

namespace foresight {

nlohmann::ordered_json arm_numbers(const HandEyeSummary& summary, const ArmNames& names,
                                   const std::optional<Pose>& T_head_base);
/// `views`: those that were solved; their pictures are shown where there are any.
HtmlReport arm_report(const HandEyeSummary& summary, const ArmViews& views);

}  // namespace foresight
