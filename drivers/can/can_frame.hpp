// A CAN frame, classic or FD, with the instant at which it was received.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/time.hpp"

namespace foresight {

/// One frame as it is on the wire (ISO 11898-1). A plain value, no allocation.
struct CanFrame {
  std::uint32_t id = 0;          ///< 11 bits, or 29 where `extended`; of an error frame the kernel's error class bits
  bool extended = false;         ///< 29-bit identifier
  bool remote = false;           ///< remote transmission request: no data, `size` is the length asked for
  bool error = false;            ///< made by the controller, never on the wire (linux/can/error.h)
  bool fd = false;               ///< CAN FD
  bool bit_rate_switch = false;  ///< FD only: data at the second bit rate
  std::uint8_t size = 0;         ///< 0 .. 8; FD also 12, 16, 20, 24, 32, 48, 64
  std::array<std::uint8_t, 64> data{};
  RobotTime time;  ///< when it was received; 0 in frames to be sent

  std::span<const std::uint8_t> payload() const { return {data.data(), remote ? std::size_t{0} : size}; }
};

}  // namespace foresight
