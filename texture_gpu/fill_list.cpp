#include "texture_gpu/fill_list.hpp"

#include <utility>

namespace foresight {

FillPass::Work FillList::list(const std::vector<AtlasChart>& charts, std::span<const PageJob> jobs) {
  std::vector<bool> changed(charts.size());
  for (const PageJob& job : jobs) changed[job.chart] = true;
  dirty_.clear();
  kept_.clear();
  chart_of_page_.clear();
  first_page_before_.resize(charts.size(), 0);
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const int count = charts[i].pages.prod();
    chart_of_page_.insert(chart_of_page_.end(), static_cast<std::size_t>(count), static_cast<std::uint32_t>(i));
    const int before = std::exchange(first_page_before_[i], charts[i].first_page);
    if (count == 0) continue;
    if (changed[i] || charts[i].relevelled) {
      dirty_.push_back(static_cast<std::uint32_t>(i));
    } else if (!kept_.empty() && kept_.back()[0] + kept_.back()[2] == before &&
               kept_.back()[1] + kept_.back()[2] == charts[i].first_page) {
      kept_.back()[2] += count;
    } else {
      kept_.push_back({before, charts[i].first_page, count});
    }
  }
  return {jobs.size(), dirty_, chart_of_page_, kept_};
}

}  // namespace foresight
