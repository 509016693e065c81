// What is known of a pixel that a camera has confirmed, in steps that one byte holds: how often pixels of one kind are
// wrong is learnt of pictures whose image has come (seat/shown_fidelity.hpp).
//
//   doubt 0 .. 191   contrast + 16 * (reach + 6 * suspect)
//   255              nothing is known of it
#pragma once

#include <bitset>
#include <cmath>

namespace foresight {

inline constexpr int kUnconfirmed = 255;  ///< doubt of what no camera has confirmed

/// Steps of trust.comp.
struct DoubtKind {
  static constexpr int kContrasts = 16, kReaches = 6, kCount = 2 * kContrasts * kReaches;
  int contrast = 0;  ///< by how many grey levels the pixels around differ: 4 steps each time that these + 3 double
  int reach = 0;     ///< by how many pixels the surface may be elsewhere: below 0.5, 1, 2, 4, 8, more
  bool suspect =
      false;  ///< what was shown there was wrong when last an image could be compared, or its light has changed

  double levels() const { return 3 * (std::exp2((contrast + 0.5) / 4) - 1); }
  double px() const { return reach == 0 ? 0.25 : std::exp2(reach - 1.5); }
};
/// `doubt`: below DoubtKind::kCount.
constexpr DoubtKind kind_of(int doubt) {
  constexpr int kOfOne = DoubtKind::kContrasts * DoubtKind::kReaches;
  return {doubt % DoubtKind::kContrasts, doubt % kOfOne / DoubtKind::kContrasts, doubt >= kOfOne};
}
constexpr int doubt_of(const DoubtKind& kind) {
  return kind.contrast + DoubtKind::kContrasts * (kind.reach + DoubtKind::kReaches * (kind.suspect ? 1 : 0));
}

/// By doubt: such pixels count as exact. Never kUnconfirmed.
using ExactKinds = std::bitset<256>;

}  // namespace foresight
