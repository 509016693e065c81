// Emergency messages (CiA 301, 7.2.7) and the names of their error codes (CiA 301 table 26, CiA 402-2).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/can/can_frame.hpp"

namespace foresight::canopen {

struct Emergency {
  int node = 0;
  std::uint16_t code = 0;           ///< 0000h: errors are gone
  std::uint8_t error_register = 0;  ///< object 1001h
  std::array<std::uint8_t, 5> manufacturer{};
};

/// Nothing where `frame` is no emergency message (COB-ID 081h .. 0FFh, 8 bytes).
std::optional<Emergency> parse_emergency(const CanFrame& frame) noexcept;

/// Static text: the meaning of the code, else that of its class; never empty.
const char* emergency_name(std::uint16_t code) noexcept;

/// The bits of the error register in words ("generic, communication"); "none" for 0. Allocates.
std::string error_register_text(std::uint8_t value);

}  // namespace foresight::canopen
