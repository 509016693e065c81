// The sweep of `foresight bench margin` as a picture.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/texel_truth.hpp"

namespace foresight {

/// One registration error and what it did.
struct MarginRow {
  double error_px = 0;
  TexelCount core, core_without, thesis, thesis_without;
};

/// A self-contained SVG: wrong texels on the left (logarithmic), right ones lost on the right.
std::string margin_plot(const std::vector<MarginRow>& rows);

}  // namespace foresight
