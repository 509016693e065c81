// Numbers and page of a hand-eye calibration.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/calibrate/arm_input.hpp"
#include "calibration/result/html_report.hpp"

namespace foresight {

/// Standard deviations, such as "0.25 mm and 0.85 mrad".
std::string robot_noise_words(const HandEyeSummary& summary);

nlohmann::ordered_json arm_numbers(const HandEyeSummary& summary, const ArmNames& names,
                                   const std::optional<Pose>& T_head_base);
/// `views`: those that were solved; their pictures are shown where there are any.
/// `kept`: the error on views that the solver has not seen, where some were kept back.
HtmlReport arm_report(const HandEyeSummary& summary, const ArmViews& views, const std::optional<HandEyeScore>& kept);

}  // namespace foresight
