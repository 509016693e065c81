// How long a frame occupies the wire, and how busy a bus is.
//
// ISO 11898-1:2015. Counted from the start bit to the end of the three bits of intermission, so that
// frames back to back fill the bus exactly:
//
//   SOF identifier control data CRC | delimiter ACK delimiter EOF intermission
//   '------- bits stuffed --------'   1         1   1         7   3
//
// A stuff bit follows five equal bits. In CAN FD that ends with the data; what comes then (stuff
// count and CRC) has a fixed stuff bit before every fourth bit.
#pragma once

#include <array>

#include "drivers/can/can_frame.hpp"

namespace foresight {

/// Bits of one frame by the bit rate at which they are sent.
struct CanBits {
  int nominal = 0;  ///< arbitration; of a frame without bit rate switch: all
  int data = 0;     ///< CAN FD with bit rate switch: from ESI to the CRC delimiter

  int total() const { return nominal + data; }
};

/// With the stuff bits that this identifier and these data need. 0 for error frames, which are no frames on the wire.
CanBits can_bits(const CanFrame& frame) noexcept;
/// With the most stuff bits that any frame of this format and length can need.
CanBits worst_can_bits(const CanFrame& frame) noexcept;

/// Bits per second of a bus; data_bit_rate only matters for CAN FD (0: as bit_rate).
struct CanBitRates {
  int bit_rate = 1'000'000;
  int data_bit_rate = 0;
};
Duration wire_time(const CanBits& bits, const CanBitRates& rates) noexcept;

/// Share of the last second in which the bus was busy, by the frames seen on it. One thread.
class CanBusLoad {
 public:
  explicit CanBusLoad(const CanBitRates& rates) : rates_(rates) {}
  /// `time` must not go back by more than the window; a frame older than that is not counted.
  void add(const CanFrame& frame, RobotTime time) noexcept;
  /// 0 .. 1 (above 1 where more frames are claimed than fit on the wire).
  double load(RobotTime now) noexcept;

  static constexpr Duration kWindow = std::chrono::seconds(1);

 private:
  void move_to(std::int64_t slot) noexcept;

  CanBitRates rates_;
  std::array<Duration, 20> busy_{};  // a ring of 50 ms slots
  std::int64_t newest_ = 0;          // slot number since the clock's epoch
};

}  // namespace foresight
