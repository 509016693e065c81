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

/// What the core's curves and columns are called: "core, margin of 1.5 px", with the default margin.
std::string core_with_margin();

/// A self-contained SVG: wrong texels on the left (logarithmic), right ones lost on the right.
std::string margin_plot(const std::vector<MarginRow>& rows);
/// Its two diagrams as JSON (common/plot_data.hpp).
std::vector<std::string> margin_plot_data(const std::vector<MarginRow>& rows);

}  // namespace foresight
