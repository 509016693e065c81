// What is known of a pixel that a camera has confirmed, in steps that one byte holds: how often pixels of one kind are
// wrong is learnt of pictures whose image has come (seat/shown_fidelity.hpp).
//
//   doubt 0 .. 223   contrast + 16 * (reach + 2 * compared)
//   224 .. 243       it was last seen in a tile that lost something when it was coded: loss_contrast() + 5 * (step - 1)
//                    (scene/coding_loss.hpp); 244: in one that lost more
//   245 .. 252       contrast / 2: the newest image alone shows it, beside an edge, where it may show another surface
//   255              nothing is known of it
#pragma once

#include <array>
#include <bitset>
#include <cstdint>

#include "scene/coding_loss.hpp"

namespace foresight {

inline constexpr int kUnconfirmed = 255;   ///< doubt of what no camera has confirmed, or may be anywhere
inline constexpr double kAnywherePx = 50;  ///< by which a surface may be elsewhere: nothing is known of what it covers

/// How the same place of the surface was shown when images could be compared of late: the mean of up to
/// kComparisonsKept times that it was shown. Once tells little of an edge, which may be right by chance.
enum class Compared : std::uint8_t {
  never,    ///< it was not shown then
  same,     ///< by kLevelsOff[0] grey levels off, about the pixel
  alike,    ///< by kLevelsOff[1]
  close,    ///< by kLevelsOff[2]
  near,     ///< by kLevelsOff[3]
  off,      ///< by more
  suspect,  ///< in a patch that was wrong the last time: something goes on there; or its light has changed since
};
inline constexpr double kLevelsOff[] = {1.5, 2.5, 4.5, 6.5};  ///< grey levels
inline constexpr std::size_t kComparisonsKept = 4;

/// Steps of trust.comp.
struct DoubtKind {
  static constexpr int kContrasts = kContrastSteps, kReaches = 2, kComparisons = 7,
                       kCount = kContrasts * kReaches * kComparisons;
  int contrast = 0;  ///< step of contrast.hpp
  int reach = 0;     ///< by how many pixels the surface may be elsewhere: below 2, more
  Compared compared = Compared::never;

  double levels() const { return contrast_levels(contrast); }
  double px() const { return reach == 0 ? 1 : 4; }
};
/// Doubt of what was last seen in a tile that lost something. Images that came tell nothing of these.
inline constexpr int kCodedAway = DoubtKind::kCount, kMostlyCodedAway = kCodedAway + kToldSteps * kLossContrasts;
/// Doubt of what may be the colour of another surface (view_alpha::kFromEdge), by two steps of contrast each.
inline constexpr int kBesideEdge = kMostlyCodedAway + 1, kKindsEnd = kBesideEdge + DoubtKind::kContrasts / 2;
/// `step`: 1 .. kLossSteps - 1; `contrast`: loss_contrast().
constexpr int coded_away(int step, int contrast) {
  return step <= kToldSteps ? kCodedAway + kLossContrasts * (step - 1) + contrast : kMostlyCodedAway;
}
/// `doubt`: below DoubtKind::kCount.
constexpr DoubtKind kind_of(int doubt) {
  constexpr int kOfOne = DoubtKind::kContrasts * DoubtKind::kReaches;
  return {doubt % DoubtKind::kContrasts, doubt % kOfOne / DoubtKind::kContrasts, static_cast<Compared>(doubt / kOfOne)};
}
constexpr int doubt_of(const DoubtKind& kind) {
  return kind.contrast + DoubtKind::kContrasts * (kind.reach + DoubtKind::kReaches * static_cast<int>(kind.compared));
}

/// What a comparison says of a pixel, in a byte: grey levels that it and those around were off, at most
/// kMostLevelsOff, or one of these.
inline constexpr int kMostLevelsOff = 253, kInPatch = 254, kNotShown = 255;

/// By doubt: such pixels count as exact. Never kUnconfirmed.
using ExactKinds = std::bitset<256>;

/// By doubt: the share of such pixels that are wrong, as far as it is known.
using KindRisks = std::array<double, kKindsEnd>;
/// Up to the one, a kind is right nearly always; beyond the other, it never counts as exact. ViewPaint's words tell
/// both.
inline constexpr double kRarelyWrong = 0.016, kOftenWrong = 0.15;
/// Grey levels beyond which a pixel is wrong.
inline constexpr double kWrongLevels = 10;

}  // namespace foresight
