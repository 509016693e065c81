// What travels with the pictures of a coded pair: its StereoFrame without the images' bytes, and what coding took away
// from them, deflated (RFC 1950), as on a thin line a pair of pictures has no more than a few kilobytes itself.
#pragma once

#include "link/messages/cdr.hpp"

namespace foresight::link {

inline constexpr std::size_t kMostNotesInflated = 65'536;  ///< bytes

struct PairNotes {
  StereoFrame frame;                      ///< without data
  std::vector<std::uint8_t> left_lost;    ///< steps of coding_loss() of the left image, row by row; empty: not known
  std::vector<std::uint8_t> loss_shares;  ///< LossShares of left images of late; empty: not known
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("frame", m.frame)("left_lost", m.left_lost)("loss_shares", m.loss_shares);
  }
};

/// Throws RuntimeFailure where there is more to say than fits.
Bytes to_notes(const PairNotes& notes);
/// Nothing where the bytes, which may be anything, are no such notes. What they say is still to be checked
/// (checks.hpp). Recordings may be older than `left_lost`, or than `loss_shares`, and have none.
std::optional<PairNotes> from_notes(std::span<const std::uint8_t> notes);

}  // namespace foresight::link
