#include "drivers/robot/operator_records.hpp"

#include <algorithm>

namespace foresight {

OperatorRecord& OperatorRecords::of(std::uint64_t id, std::uint64_t keep) noexcept {
  auto found = std::find_if(records_.begin(), records_.end(), [id](const OperatorRecord& r) { return r.id == id; });
  if (found == records_.end()) {
    const auto rank = [keep](const OperatorRecord& r) { return r.id == keep && keep != 0 ? UINT64_MAX : r.heard; };
    found = std::min_element(records_.begin(), records_.end(),
                             [&](const auto& one, const auto& other) { return rank(one) < rank(other); });
    *found = {.id = id};
  }
  found->heard = ++heard_;
  return *found;
}

void OperatorRecords::forget_released() noexcept {
  for (OperatorRecord& record : records_) record.released = false;
}

}  // namespace foresight
