// What travels with the pictures of a coded pair: its StereoFrame without the images' bytes, deflated (RFC 1950), as on
// a thin line a pair of pictures has no more than a few kilobytes itself.
#pragma once

#include "link/messages/cdr.hpp"

namespace foresight::link {

inline constexpr std::size_t kMostNotesInflated = 65'536;  ///< bytes

/// `frame`: without data. Throws RuntimeFailure where there is more to say than fits.
Bytes to_notes(const StereoFrame& frame);
/// Nothing where the bytes, which may be anything, are no such notes. What they say is still to be checked
/// (checks.hpp).
std::optional<StereoFrame> from_notes(std::span<const std::uint8_t> notes);

}  // namespace foresight::link
