#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drives/wire.hpp"

namespace foresight::sim::canopen_test {
namespace {

using testing::ElementsAre;

std::vector<std::string> texts(const std::vector<CanFrame>& frames) {
  std::vector<std::string> out;
  for (const CanFrame& frame : frames) out.push_back(text_of(frame));
  return out;
}

TEST(CanopenNode, BootsAndObeysNmt) {
  Wire wire({cia402_drive(2)});
  EXPECT_THAT(texts(wire.pass(20ms)), ElementsAre("702#00"));
  EXPECT_EQ(wire.download(2, 0x1017, 0, 10, 2), 0u);
  const auto beats = texts(wire.pass(25ms));
  EXPECT_THAT(beats, ElementsAre("702#7F", "702#7F", "702#7F"));
  wire.send(0, {2, 3});
  EXPECT_EQ(text_of(*wire.wait(0x702)), "702#7F") << "meant for another";
  wire.send(0, {2, 0});
  wire.pass(5ms);
  EXPECT_EQ(text_of(*wire.wait(0x702)), "702#04");
  EXPECT_FALSE(wire.upload(2, 0x1000)) << "no SDO while stopped";
  EXPECT_EQ(wire.aborted, 1u);
  wire.send(0, {1, 2});
  wire.pass(5ms);
  EXPECT_EQ(text_of(*wire.wait(0x702)), "702#05");
  wire.send(0, {0x81, 2});
  const auto reset = texts(wire.pass(100ms));
  ASSERT_FALSE(reset.empty());
  EXPECT_EQ(reset.back(), "702#00") << "heartbeat is off again";
}

TEST(CanopenNode, TellsWhoItIs) {
  NodeConfig config = cia402_drive(2);
  config.vendor = 0x29c;
  config.product = 77;
  Wire wire({config});
  wire.pass(5ms);
  EXPECT_EQ(wire.upload(2, 0x1000), 0x20192);
  EXPECT_EQ(wire.upload(2, 0x1018, 1), 0x29c);
  EXPECT_EQ(wire.upload(2, 0x1018, 2), 77);
  EXPECT_EQ(wire.upload(2, 0x1018, 4), 4711);
  wire.rack.inject(0, DriveFault::wrong_identity);
  EXPECT_NE(wire.upload(2, 0x1018, 4), 4711);
  wire.rack.inject(0, DriveFault::recover);
  EXPECT_EQ(wire.upload(2, 0x1018, 4), 4711);
}

TEST(SdoServer, AbortsWithTheRightCode) {
  Wire wire({cia402_drive(2)});
  wire.pass(5ms);
  EXPECT_EQ(wire.download(2, 0x5FFF, 0, 0, 4), 0x06020000u);
  EXPECT_EQ(wire.download(2, 0x607D, 9, 0, 4), 0x06090011u);
  EXPECT_EQ(wire.download(2, 0x6041, 0, 0, 2), 0x06010002u);
  EXPECT_EQ(wire.download(2, 0x6040, 0, 0, 4), 0x06070012u);
  EXPECT_EQ(wire.download(2, 0x607A, 0, 0, 2), 0x06070013u);
  EXPECT_EQ(wire.download(2, 0x605A, 0, 9, 2), 0x06090031u);
  EXPECT_EQ(wire.download(2, 0x605A, 0, -1, 2), 0x06090032u);
  EXPECT_EQ(wire.download(2, 0x6060, 0, 4, 1), 0x06090030u) << "torque mode is not there";
  EXPECT_FALSE(wire.upload(2, 0x1018, 7));
  EXPECT_EQ(wire.aborted, 0x06090011u);
  wire.send(0x602, {0xC0, 0, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(text_of(*wire.wait(0x582)), "582#8000100001000405") << "no block transfers";
  EXPECT_EQ(wire.download(2, 0x6081, 0, 1234, 4), 0u);
  EXPECT_EQ(wire.upload(2, 0x6081), 1234);
}

TEST(SdoServer, MovesLongValuesInSegments) {
  Wire wire({cia402_drive(2)});
  wire.pass(5ms);
  wire.send(0x602, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  const auto head = wire.wait(0x582);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->data[0], 0x41);
  std::string name;
  for (int toggle = 0; name.size() < 100; toggle ^= 0x10) {
    wire.send(0x602, {0x60 | toggle, 0, 0, 0, 0, 0, 0, 0});
    const auto segment = wire.wait(0x582);
    ASSERT_TRUE(segment);
    ASSERT_EQ(segment->data[0] & 0xF0, toggle);
    name.append(segment->data.begin() + 1, segment->data.begin() + 8 - (segment->data[0] >> 1 & 7));
    if (segment->data[0] & 1) break;
  }
  EXPECT_EQ(name, "Foresight emulated servo drive");
  EXPECT_EQ(head->data[4], name.size());
}

TEST(SdoServer, TakesSegmentsAndChecksTheToggleBitAndTheLength) {
  Wire wire({cia402_drive(2)});
  wire.pass(5ms);
  const auto begin = [&] {
    wire.send(0x602, {0x21, 0x81, 0x60, 0, 4, 0, 0, 0});
    EXPECT_EQ(text_of(*wire.wait(0x582)), "582#6081600000000000");
  };
  begin();
  wire.send(0x602, {0x07, 0x78, 0x56, 0x34, 0x12, 0, 0, 0});
  EXPECT_EQ(text_of(*wire.wait(0x582)), "582#2000000000000000");
  EXPECT_EQ(wire.upload(2, 0x6081), 0x12345678);
  begin();
  wire.send(0x602, {0x17, 1, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(text_of(*wire.wait(0x582)), "582#8081600000000305");
  begin();
  wire.send(0x602, {0x0B, 1, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(text_of(*wire.wait(0x582)), "582#8081600010000706") << "two bytes instead of four";
  begin();
  const auto silence = wire.wait(0x582, 1500ms);
  ASSERT_TRUE(silence);
  EXPECT_EQ(text_of(*silence), "582#8081600000000405") << "timed out";
}

// The mapping procedure of CiA 301, and what is refused when it is not followed.
TEST(PdoSet, IsMappedOverSdoAsTheStandardSays) {
  Wire wire({cia402_drive(2)});
  wire.pass(5ms);
  EXPECT_EQ(wire.download(2, 0x1A00, 0, 0, 1), 0x08000022u) << "while the PDO is valid";
  EXPECT_EQ(wire.download(2, 0x1800, 1, 0x80000182, 4), 0u);
  EXPECT_EQ(wire.download(2, 0x1A00, 1, 0x60640020, 4), 0x08000022u) << "while its count is not 0";
  EXPECT_EQ(wire.download(2, 0x1A00, 0, 0, 1), 0u);
  EXPECT_EQ(wire.download(2, 0x1A00, 1, 0x5FFF0020, 4), 0x06020000u);
  EXPECT_EQ(wire.download(2, 0x1A00, 1, 0x60980008, 4), 0x06040041u) << "homing method cannot be mapped";
  EXPECT_EQ(wire.download(2, 0x1A00, 1, 0x60640010, 4), 0x06040041u) << "wrong size";
  for (unsigned sub = 1; sub <= 3; ++sub) EXPECT_EQ(wire.download(2, 0x1A00, sub, 0x60640020, 4), 0u);
  EXPECT_EQ(wire.download(2, 0x1A00, 0, 3, 1), 0x06040042u) << "12 bytes";
  EXPECT_EQ(wire.download(2, 0x1A00, 0, 2, 1), 0u);
  EXPECT_EQ(wire.download(2, 0x1800, 2, 250, 1), 0x06090030u) << "reserved transmission type";
  EXPECT_EQ(wire.download(2, 0x1800, 2, 2, 1), 0u);
  EXPECT_EQ(wire.download(2, 0x1800, 1, 0x701, 4), 0x06090030u) << "an identifier of error control";
  EXPECT_EQ(wire.download(2, 0x1800, 1, 0x1A7, 4), 0u);
  wire.send(0, {1, 2});
  EXPECT_TRUE(wire.pass(50ms).empty()) << "synchronous now";
  int pdos = 0;
  for (int i = 0; i < 6; ++i) {
    wire.send(0x80, {});
    for (const CanFrame& got : wire.pass(5ms)) pdos += got.id == 0x1A7 && got.size == 8;
  }
  EXPECT_EQ(pdos, 3) << "every second SYNC";
}

TEST(PdoSet, SendsOnChangeWithinItsTimers) {
  Wire wire({cia402_drive(2)});
  wire.pass(5ms);
  EXPECT_EQ(wire.download(2, 0x1800, 1, 0x80000182, 4), 0u);
  EXPECT_EQ(wire.download(2, 0x1800, 3, 200, 2), 0u);  // at most every 20 ms
  EXPECT_EQ(wire.download(2, 0x1800, 5, 50, 2), 0u);   // at least every 50 ms
  EXPECT_EQ(wire.download(2, 0x1800, 1, 0x182, 4), 0u);
  wire.send(0, {1, 2});
  wire.wait(0x182);
  const auto quiet = wire.pass(151ms);
  EXPECT_EQ(quiet.size(), 3u) << "the event timer";
  wire.send(0x202, {6, 0});
  wire.send(0x202, {7, 0});
  const auto after = wire.pass(45ms);
  ASSERT_EQ(after.size(), 1u) << "inhibited until 20 ms after the last";
  EXPECT_EQ(after[0].data[0] & 0x6F, 0x23);
}

TEST(PdoSet, ComplainsOfAShortFrame) {
  Wire wire({cia402_drive(2)});
  wire.pass(5ms);
  wire.send(0, {1, 2});
  wire.pass(5ms);
  wire.send(0x202, {6});
  const auto complaint = wire.wait(0x82);
  ASSERT_TRUE(complaint);
  EXPECT_EQ(text_of(*complaint), "082#1082110000000000");
  EXPECT_EQ(wire.upload(2, 0x1003, 0), 1);
  EXPECT_EQ(wire.upload(2, 0x1003, 1), 0x8210);
  EXPECT_EQ(wire.status(2) & 0x6F, 0x40) << "and did not take it";
  EXPECT_EQ(wire.download(2, 0x1003, 0, 0, 1), 0u);
  EXPECT_EQ(wire.upload(2, 0x1003, 0), 0);
}

}  // namespace
}  // namespace foresight::sim::canopen_test
