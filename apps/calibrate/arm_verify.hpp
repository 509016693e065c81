// `verify` of a result of `calibrate arm`.
#pragma once

#include "apps/calibrate/arm_input.hpp"

namespace foresight {

struct ArmVerify {
  std::filesystem::path result;
  ArmInput input;
  std::optional<double> px;  ///< limit; nothing: 1.5 times the result's own score
  std::optional<std::filesystem::path> json;
};

/// Scores the result on views of the same board; those that it was solved from do not count. Returns 0 or 1.
int verify_arm(const ArmVerify& options);

}  // namespace foresight
