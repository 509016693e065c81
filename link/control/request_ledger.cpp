#include "link/control/request_ledger.hpp"

#include <algorithm>

namespace foresight {

bool StopLedger::note_new(const Request& stop) {
  const Entry entry{stop.id, stop.given};
  if (stop.id != 0 && std::find(entries_.begin(), entries_.end(), entry) != entries_.end()) return false;
  entries_[next_] = entry;
  next_ = (next_ + 1) % kKept;
  return true;
}

std::optional<RequestOutcome> RequestLedger::answered(const Request& request) const {
  for (const Entry& entry : entries_)
    if (entry.id == request.id && request.id != 0) return entry.outcome;
  if (request.id > newest_ || request.what == LineRequest::emergency_stop) return std::nullopt;
  return RequestOutcome::overtaken;
}

void RequestLedger::note(std::uint64_t id, RequestOutcome outcome) {
  entries_[next_] = {id, outcome};
  next_ = (next_ + 1) % kKept;
  newest_ = std::max(newest_, id);
}

}  // namespace foresight
