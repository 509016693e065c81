// How much less is known of errors where few were seen, or where those that were seen are alike.
#pragma once

#include <algorithm>
#include <cstddef>

namespace foresight {

/// Errors in the order of their instants. Neighbouring ones are alike, and count as fewer: (1 - r) / (1 + r) of them
/// where r is the correlation of neighbours (Bartlett 1946).
class AlikeErrors {
 public:
  void add(double off) noexcept {
    squares_ += off * off;
    products_ += off * last_;
    last_ = off;
    ++count_;
  }
  double squares() const noexcept { return squares_; }
  std::size_t count() const noexcept { return count_; }
  /// How many independent ones tell as much.
  double independent() const noexcept {
    const double alike = std::clamp(squares_ > 0 ? products_ / squares_ : 0.0, 0.0, 0.999);
    return static_cast<double>(count_) * (1 - alike) / (1 + alike);
  }

 private:
  double squares_ = 0, products_ = 0, last_ = 0;
  std::size_t count_ = 0;
};

/// By how much wider than 1.96 sigma the range is that holds 95 % of normal errors, where sigma is the rms of so many
/// independent ones: the quantile of Student's distribution over the normal one's, by its Cornish-Fisher expansion
/// (Abramowitz and Stegun, 26.7.5). Fewer than two count as two.
inline double widening_of_few(double independent) noexcept {
  constexpr double z = 1.959964, z2 = z * z;
  const double n = std::max(2.0, independent);
  const double g1 = (z2 + 1) / 4, g2 = ((5 * z2 + 16) * z2 + 3) / 96, g3 = (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384;
  return 1 + (g1 + (g2 + g3 / n) / n) / n;
}

}  // namespace foresight
