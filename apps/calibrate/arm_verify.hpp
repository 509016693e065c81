// `verify` of a result of `calibrate arm`.
#pragma once

#include "apps/calibrate/arm_input.hpp"

namespace foresight {

/// The limits of `verify`, as a multiple of a result's own score: new views differ from those of the session, a moved
/// lens differs far more.
constexpr double kWorseThanScore = 1.5;

struct ArmVerify {
  std::filesystem::path result;
  ArmInput input;
  std::optional<double> px;  ///< limit; nothing: kWorseThanScore times the result's own score
  std::optional<std::filesystem::path> json;
};

/// Scores the result on views of the same board; those that it was solved from do not count. Returns 0 or 1.
int verify_arm(const ArmVerify& options);

}  // namespace foresight
