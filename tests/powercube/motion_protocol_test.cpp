#include "drivers/powercube/motion_protocol.hpp"

#include <gtest/gtest.h>

#include <random>

#include "protocol_data.hpp"

namespace foresight::powercube::motion_protocol_test {
namespace {

std::string words(const std::optional<MotionMessage>& message) {
  return message ? describe(*message) : "unknown";
}

TEST(MotionProtocol, VectorsOnCan) {
  const auto file = can_data("schunk_motion_protocol/can_vectors.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no vectors at " << file << "; set FORESIGHT_DATA";
  const std::vector<std::string> meanings = {
      "to module 1: reference",
      "module 1: reference: ok",
      "module 1: stands at 5.791764",
      "to module 1: move to position 10",
      "module 1: will be there in s 3.358333",
      "module 1: in position 9.997",
      "to module 1: tell the state every s 1",
      "module 1: position 1.012, moving, 0x00 no error",
      "module 1: position 5.0545, moving, 0x00 no error",
      "module 1: error 0x74 ERROR MOTOR VOLTAGE LOW",
      "to module 1: acknowledge",
      "module 1: acknowledge: ok",
      "module 1: info 0x08 no error",
      "to module 1: check communication",
      "module 1: check communication -1.2345",
  };
  const auto rows = read_rows(file);
  ASSERT_EQ(rows.size(), meanings.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CanFrame frame;
    frame.id = static_cast<std::uint32_t>(std::stoul(rows[i][2], nullptr, 0));
    for (std::uint8_t b : bytes_of(rows[i][3])) frame.data[frame.size++] = b;
    const auto message = decode_motion(frame);
    ASSERT_TRUE(message) << rows[i][3];
    EXPECT_EQ(message->module, 1);
    EXPECT_FALSE(message->wrong_length);
    EXPECT_EQ(describe(*message), meanings[i]);
  }
}

TEST(MotionProtocol, VectorsWithoutBus) {
  const auto file = can_data("schunk_motion_protocol/serial_and_generic_vectors.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no vectors at " << file << "; set FORESIGHT_DATA";
  int read = 0;
  for (const auto& row : read_rows(file)) {
    if (row[0] == "rs232") continue;  // with what a serial line puts around them
    const auto bytes = bytes_of(row[2]);
    const auto sender = row[1] == "M>S" ? MotionSender::master : MotionSender::module;
    const auto message = decode_motion(sender, 1, bytes);
    ASSERT_TRUE(message) << row[2];
    EXPECT_EQ(message->sender, sender);
    const bool misprint =
        row[3].find("misprint") != std::string::npos || row[3].find("as printed") != std::string::npos;
    EXPECT_EQ(message->wrong_length, misprint) << row[2];
    ++read;
  }
  EXPECT_GT(read, 8);
}

TEST(MotionProtocol, MeaningsWithoutBus) {
  const auto read = [](MotionSender sender, std::vector<std::uint8_t> bytes) {
    return words(decode_motion(sender, 1, bytes));
  };
  EXPECT_EQ(read(MotionSender::module, {0x05, 0xB0, 0xCD, 0xCC, 0x04, 0x41}), "module 1: will be there in s 8.3");
  EXPECT_EQ(read(MotionSender::master, {0x05, 0xB3, 0, 0, 0x60, 0x40}), "to module 1: move with A 3.5");
  EXPECT_EQ(read(MotionSender::module, {0x05, 0xB3, 0x4F, 0x4B}),
            "module 1: move with current: ok (wrong length byte)");
  EXPECT_EQ(read(MotionSender::master, {0x05, 0xB5, 0x9A, 0x99, 0x31, 0x41}), "to module 1: move with velocity 11.1");
  EXPECT_EQ(read(MotionSender::module, {0x02, 0x88, 0xDA}), "module 1: error 0xDA ERROR TOW (following error)");
  EXPECT_EQ(read(MotionSender::module, {0x02, 0x89, 0xD6}),
            "module 1: warning 0xD6 ERROR SOFT HIGH (upper software limit)");
  EXPECT_EQ(read(MotionSender::module, {0x02, 0x99, 0xD6}), "unknown");
  EXPECT_EQ(read(MotionSender::module, {0x02}), "unknown");
}

TEST(MotionProtocol, RandomBytesDoNoHarm) {
  std::mt19937 random(1);
  int known = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::uint8_t> bytes(random() % 10);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    if (bytes.size() > 1 && i % 2 == 0) bytes[1] = static_cast<std::uint8_t>(0x88 + random() % 0x60);
    const auto message = decode_motion(static_cast<MotionSender>(random() % 3), 1, bytes);
    known += message.has_value();
    EXPECT_FALSE(words(message).empty());
  }
  EXPECT_GT(known, 0);
}

}  // namespace
}  // namespace foresight::powercube::motion_protocol_test
