#include "seat/trust_switch.hpp"

#include <fmt/core.h>

namespace foresight {
namespace {

/// Is `holds` so for `long_enough`, with this?
bool lasts(std::optional<OperatorTime>& since, bool holds, OperatorTime now, Duration long_enough) {
  if (!holds) {
    since.reset();
    return false;
  }
  if (!since) since = now;
  return now - *since >= long_enough;
}

}  // namespace

void TrustSwitch::judged(OperatorTime now, const std::string& fault) {
  if (!fault.empty()) fault_ = fault;
  is_over_ = fault.empty();
  const bool is_well = lasts(valid_since_, fault.empty(), now, options_.valid_after);
  invalid_ = !fault.empty() || (invalid_ && !is_well);
}

void TrustSwitch::compared(OperatorTime now, double fidelity_db) {
  fidelity_db_ = fidelity_db;
  const bool is_low = lasts(low_since_, fidelity_db < options_.lowest_db, now, options_.after);
  const bool is_high =
      lasts(high_since_, fidelity_db >= options_.lowest_db + options_.back_margin_db, now, options_.back_after);
  poor_ = is_low || (poor_ && !is_high);
}

std::string TrustSwitch::why() const {
  if (invalid_ && is_over_)
    return "just now: " + fault_ + "; it can be predicted again, and is shown as soon as that has lasted";
  if (invalid_) return fault_;
  return poor_ ? fmt::format("what was shown was {:.0f} dB like the image that came, below {:.0f}", fidelity_db_,
                             options_.lowest_db)
               : "";
}

}  // namespace foresight
