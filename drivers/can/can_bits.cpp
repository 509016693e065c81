#include "drivers/can/can_bits.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr int kEnd = 1 + 1 + 1 + 7 + 3;  // CRC delimiter, ACK, its delimiter, end of frame, intermission

/// Counts the stuff bits of a stream, and takes the CRC of classic frames along.
class BitStream {
 public:
  void push(std::uint32_t value, int bits) {
    for (int i = bits - 1; i >= 0; --i) push_bit((value >> i) & 1);
  }
  void push_bit(unsigned bit) {
    const unsigned feedback = bit ^ (crc_ >> 14 & 1);
    crc_ = (crc_ << 1) & 0x7fff;
    if (feedback) crc_ ^= 0x4599;
    if (pending_stuff_) ++stuff_;
    pending_stuff_ = false;
    ++bits_;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    if (run_ < 5) return;
    pending_stuff_ = true;  // counted when the stream goes on: CAN FD sends a fixed one at its end instead
    last_ = bit ^ 1;
    run_ = 1;
  }
  void end_with_stuff() {
    if (pending_stuff_) ++stuff_;
    pending_stuff_ = false;
  }
  std::uint32_t crc() const { return crc_; }
  int bits() const { return bits_ + stuff_; }

 private:
  std::uint32_t crc_ = 0;
  unsigned last_ = 2;
  int run_ = 0, bits_ = 0, stuff_ = 0;
  bool pending_stuff_ = false;
};

unsigned data_length_code(const CanFrame& frame) {
  static constexpr std::array<int, 16> kSizes{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  return static_cast<unsigned>(std::lower_bound(kSizes.begin(), kSizes.end(), frame.size) - kSizes.begin());
}

int data_bytes(const CanFrame& frame) {
  return static_cast<int>(frame.payload().size());
}

/// Start bit to the bit in front of the control field's reserved bits.
void push_arbitration(BitStream& stream, const CanFrame& frame) {
  stream.push_bit(0);
  if (frame.extended) {
    stream.push(frame.id >> 18, 11);
    stream.push(0b11, 2);  // SRR, IDE
    stream.push(frame.id & 0x3ffff, 18);
    stream.push_bit(frame.remote);
  } else {
    stream.push(frame.id, 11);
    stream.push_bit(frame.remote);
    stream.push_bit(0);  // IDE
  }
}

CanBits classic_bits(const CanFrame& frame) {
  BitStream stream;
  push_arbitration(stream, frame);
  stream.push(0, frame.extended ? 2 : 1);
  stream.push(std::min<unsigned>(data_length_code(frame), 8), 4);
  for (const std::uint8_t byte : frame.payload()) stream.push(byte, 8);
  stream.push(stream.crc(), 15);
  stream.end_with_stuff();
  return {stream.bits() + kEnd, 0};
}

/// Stuff count (3 bits and parity), CRC, and a fixed stuff bit before every fourth of these bits.
int fd_check_bits(const CanFrame& frame) {
  const int bits = 4 + (frame.size <= 16 ? 17 : 21);
  return bits + (bits + 3) / 4;
}

CanBits split_fd(const CanFrame& frame, int up_to_brs, int stuffed_after) {
  const int fast = stuffed_after + fd_check_bits(frame) + 1;  // the CRC delimiter ends the fast part
  if (!frame.bit_rate_switch) return {up_to_brs + fast + kEnd - 1, 0};
  return {up_to_brs + kEnd - 1, fast};
}

CanBits fd_bits(const CanFrame& frame) {
  BitStream stream;
  push_arbitration(stream, frame);
  stream.push(0b10, 2);  // FDF, reserved
  stream.push_bit(frame.bit_rate_switch);
  const int up_to_brs = stream.bits();
  stream.push_bit(0);  // ESI: error-active
  stream.push(data_length_code(frame), 4);
  for (const std::uint8_t byte : frame.payload()) stream.push(byte, 8);
  return split_fd(frame, up_to_brs, stream.bits() - up_to_brs);
}

}  // namespace

CanBits can_bits(const CanFrame& frame) noexcept {
  if (frame.error) return {};
  return frame.fd ? fd_bits(frame) : classic_bits(frame);
}

CanBits worst_can_bits(const CanFrame& frame) noexcept {
  if (frame.error) return {};
  // A first stuff bit after five bits and then, the stuff bit counting as the first of the next five, after every four.
  const int arbitration = frame.extended ? 33 : 14;  // SOF .. RTR or IDE
  if (!frame.fd) {
    const int bits = arbitration + (frame.extended ? 2 : 1) + 4 + 8 * data_bytes(frame) + 15;
    return {bits + (bits - 1) / 4 + kEnd, 0};
  }
  const int up_to_brs = arbitration + 3, after = 1 + 4 + 8 * data_bytes(frame);
  const int first_stuff = (up_to_brs - 2) / 4;        // those sent before the bit after BRS
  const int all_stuff = (up_to_brs + after - 2) / 4;  // none after the last bit, see push_bit()
  return split_fd(frame, up_to_brs + first_stuff, after + all_stuff - first_stuff);
}

Duration wire_time(const CanBits& bits, const CanBitRates& rates) noexcept {
  const int fast = rates.data_bit_rate > 0 ? rates.data_bit_rate : rates.bit_rate;
  return Duration{bits.nominal * 1'000'000'000LL / rates.bit_rate + bits.data * 1'000'000'000LL / fast};
}

namespace {
constexpr Duration kSlot = CanBusLoad::kWindow / 20;
}

void CanBusLoad::move_to(std::int64_t slot) noexcept {
  const auto size = static_cast<std::int64_t>(busy_.size());
  for (std::int64_t s = std::max(newest_ + 1, slot - size + 1); s <= slot; ++s)
    busy_[static_cast<std::size_t>(s % size)] = Duration{0};
  newest_ = std::max(newest_, slot);
}

void CanBusLoad::add(const CanFrame& frame, RobotTime time) noexcept {
  const auto size = static_cast<std::int64_t>(busy_.size());
  const std::int64_t slot = time.ns / kSlot.count();
  move_to(slot);
  if (slot <= newest_ - size) return;
  busy_[static_cast<std::size_t>(slot % size)] += wire_time(can_bits(frame), rates_);
}

double CanBusLoad::load(RobotTime now) noexcept {
  move_to(now.ns / kSlot.count());
  Duration sum{0};
  for (const Duration busy : busy_) sum += busy;
  // The newest slot is not over yet.
  const Duration seen = kWindow - kSlot + Duration{now.ns % kSlot.count()};
  return to_seconds(sum) / to_seconds(seen);
}

}  // namespace foresight
