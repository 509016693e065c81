// The reasons for which an SDO transfer is aborted (CiA 301, 7.2.4.3.17).
#pragma once

#include <cstdint>

namespace foresight::canopen {

inline constexpr std::uint32_t kAbortToggle = 0x05030000;
inline constexpr std::uint32_t kAbortTimeout = 0x05040000;
inline constexpr std::uint32_t kAbortCommand = 0x05040001;
inline constexpr std::uint32_t kAbortMemory = 0x05040005;
inline constexpr std::uint32_t kAbortNoObject = 0x06020000;
inline constexpr std::uint32_t kAbortLength = 0x06070010;
inline constexpr std::uint32_t kAbortNoSubIndex = 0x06090011;

/// Static text; "unknown abort code" for a code that the standard does not have.
const char* abort_name(std::uint32_t code) noexcept;

/// The object or the sub-index is not there: the answer of a device that lacks an optional object.
constexpr bool means_absent(std::uint32_t code) {
  return code == kAbortNoObject || code == kAbortNoSubIndex;
}

}  // namespace foresight::canopen
