// What there is to fill after an extraction, and what stays as it is.
#pragma once

#include <span>
#include <vector>

#include "texture_gpu/chart_atlas.hpp"
#include "texture_gpu/fill_pass.hpp"

namespace foresight {

/// One thread.
class FillList {
 public:
  /// `jobs`: the pages that were extracted. Coarse colours of charts that did not change move with their place in the
  /// page table since the last call. Valid until the next one.
  FillPass::Work list(const std::vector<AtlasChart>& charts, std::span<const PageJob> jobs);

 private:
  std::vector<std::uint32_t> dirty_, chart_of_page_;
  std::vector<std::array<int, 3>> kept_;
  std::vector<int> first_page_before_;
};

}  // namespace foresight
