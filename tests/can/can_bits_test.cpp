#include "drivers/can/can_bits.hpp"

#include <gtest/gtest.h>

#include "tests/can/frames.hpp"

namespace foresight::can_bits_test {
namespace {

using namespace std::chrono_literals;

/// The same numbers from text: every bit a character, stuffed by replacing runs of five. Slow and different.
int stuffed_length(const std::string& bits, bool stuff_after_last) {
  int stuff = 0;
  std::string sent;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    sent += bits[i];
    const bool run = sent.size() >= 5 && sent.substr(sent.size() - 5) == std::string(5, sent.back());
    if (run && (i + 1 < bits.size() || stuff_after_last)) {
      sent += sent.back() == '0' ? '1' : '0';
      ++stuff;
    }
  }
  return static_cast<int>(bits.size()) + stuff;
}

std::string binary(std::uint64_t value, int digits) {
  std::string out;
  for (int i = digits - 1; i >= 0; --i) out += value >> i & 1 ? '1' : '0';
  return out;
}

/// CRC-15 by dividing polynomials written as text.
std::string crc15(std::string bits) {
  const std::string divisor = "1100010110011001";  // x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1
  bits += std::string(15, '0');
  for (std::size_t i = 0; i + 15 < bits.size(); ++i)
    if (bits[i] == '1')
      for (std::size_t k = 0; k < 16; ++k) bits[i + k] = bits[i + k] == divisor[k] ? '0' : '1';
  return bits.substr(bits.size() - 15);
}

int classic_reference(const CanFrame& f) {
  std::string bits = "0";
  if (f.extended)
    bits += binary(f.id >> 18, 11) + "11" + binary(f.id & 0x3ffff, 18) + (f.remote ? "1" : "0") + "00";
  else
    bits += binary(f.id, 11) + (f.remote ? "1" : "0") + "00";
  bits += binary(f.size, 4);
  for (const std::uint8_t byte : f.payload()) bits += binary(byte, 8);
  return stuffed_length(bits + crc15(bits), true) + 13;
}

TEST(CanBits, ClassicFramesAgreeWithATextReference) {
  std::mt19937 random(1);
  int compared = 0;
  while (compared < 3000) {
    const CanFrame f = random_frame(random);
    if (f.fd) continue;
    ASSERT_EQ(can_bits(f).total(), classic_reference(f)) << compared;
    ++compared;
  }
}

TEST(CanBits, KnownLengths) {
  // Without stuff bits 47 + 8 n and 67 + 8 n; 135 and 160 are the well-known worst cases of 8 bytes (Davis et al.,
  // 2007).
  EXPECT_EQ(worst_can_bits(frame(0, {0, 0, 0, 0, 0, 0, 0, 0})).total(), 135);
  CanFrame extended = frame(0, {0, 0, 0, 0, 0, 0, 0, 0});
  extended.extended = true;
  EXPECT_EQ(worst_can_bits(extended).total(), 160);
  EXPECT_EQ(worst_can_bits(frame(0)).total(), 55);
  EXPECT_EQ(can_bits(frame(0x555)).nominal, 47 + 1) << "DLC 0 after r0 is a run of zeros";
  CanFrame error;
  error.error = true;
  EXPECT_EQ(can_bits(error).total(), 0);
}

TEST(CanBits, FdFramesOfAlternatingBits) {
  // No stuff bit but the fixed ones: count the fields of ISO 11898-1 by hand.
  CanFrame f = frame(0x555);
  f.fd = true;
  f.size = 8;
  f.data.fill(0x55);
  // SOF 11 RRS IDE FDF res BRS | ESI DLC 64 | 4 + 17 and 6 fixed | delimiter | ACK delimiter 7 3
  const int arbitration = 1 + 11 + 1 + 1 + 1 + 1 + 1, data = 1 + 4 + 64 + 21 + 6 + 1, end = 1 + 1 + 7 + 3;
  EXPECT_EQ(can_bits(f).total(), arbitration + data + end);
  f.bit_rate_switch = true;
  const CanBits with_switch = can_bits(f);
  EXPECT_EQ(with_switch.data, data);
  EXPECT_EQ(with_switch.nominal, arbitration + end);
  f.size = 64;
  EXPECT_EQ(can_bits(f).data, 1 + 4 + 512 + 25 + 7 + 1) << "the longer CRC above 16 bytes";
}

TEST(CanBits, NoFrameIsLongerThanTheWorstOfItsKind) {
  std::mt19937 random(2);
  for (int i = 0; i < 10000; ++i) {
    const CanFrame f = random_frame(random);
    const CanBits exact = can_bits(f), worst = worst_can_bits(f);
    ASSERT_LE(exact.total(), worst.total()) << i;
    ASSERT_GE(exact.total(), f.fd ? 62 : 47) << i;
  }
}

TEST(CanBits, WireTimeUsesBothRates) {
  EXPECT_EQ(wire_time({47, 0}, {1'000'000, 0}), 47us);
  EXPECT_EQ(wire_time({30, 100}, {500'000, 2'000'000}), 60us + 50us);
  EXPECT_EQ(wire_time({30, 100}, {500'000, 0}), 260us);
}

TEST(CanBusLoad, IsTheShareOfTheLastSecond) {
  CanBusLoad load({1'000'000, 0});
  const CanFrame f = frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8});
  const double expected = to_seconds(wire_time(can_bits(f), {1'000'000, 0})) * 4000;
  RobotTime now;
  for (int i = 0; i < 8000; ++i, now = now + 250us) load.add(f, now);
  EXPECT_NEAR(load.load(now), expected, 0.01 * expected);
  EXPECT_NEAR(load.load(now + 500ms), expected / 2, 0.06 * expected) << "half of the window silent";
  EXPECT_EQ(load.load(now + 2s), 0);
}

}  // namespace
}  // namespace foresight::can_bits_test
