// When the view as it will be gives way to the newest image, and when it comes back. Pure decisions: time is an
// argument.
//
//   fidelity  ----.   back_db .......     falls back once it was below lowest_db for `after`,
//                  '-.________.--'        returns once it was above back_db for `back_after`
//             lowest_db .......
//
// A prediction that is invalid gives way at once, and returns once it was valid for `valid_after`.
#pragma once

#include <optional>
#include <string>

#include "link/control/messages.hpp"

namespace foresight {

struct TrustSwitchOptions {
  /// Below it, what is shown is hardly better than the newest image: that had 12 to 18 dB over lines of 200 to 1,000
  /// ms, a view that is well 24 to 35 (docs/operating.md).
  double lowest_db = 20;
  double back_margin_db = 2;  ///< above it, to come back
  Duration after = std::chrono::milliseconds(400), back_after = std::chrono::milliseconds(1000);
  Duration valid_after = std::chrono::milliseconds(500);
};

/// One thread.
class TrustSwitch {
 public:
  explicit TrustSwitch(TrustSwitchOptions options = {}) : options_(options) {}

  /// At `now`, which never goes back: `fault` is why the prediction is invalid, "" where it is not.
  void judged(OperatorTime now, const std::string& fault);
  /// What was shown was as good as this, as is known since `now`.
  void compared(OperatorTime now, double fidelity_db);

  /// The newest image is to be shown.
  bool falls_back() const { return invalid_ || poor_; }
  /// Why, in words; "" where it does not. Of what is over, that it is.
  std::string why() const;

 private:
  TrustSwitchOptions options_;
  bool invalid_ = false, poor_ = false;
  std::string fault_;
  bool is_over_ = false;  // the fault
  double fidelity_db_ = 0;
  std::optional<OperatorTime> valid_since_, low_since_, high_since_;
};

}  // namespace foresight
