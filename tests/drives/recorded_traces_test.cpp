// Real drives' answers, recorded by their users, against ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/drives/wire.hpp"
#include "tests/support/folders.hpp"

namespace foresight::sim::recorded_traces_test {
namespace {

std::filesystem::path traces() {
  return data_folder() / "can/cia402_traces";
}

// The frames of a candump or of lines "dir id#data", in order.
std::vector<CanFrame> frames_of(const std::string& file) {
  std::ifstream in(traces() / file);
  std::vector<CanFrame> out;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;)
      if (word.size() >= 4 && word[3] == '#') out.push_back(frame_of(word));
  }
  return out;
}

class RecordedTraces : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(traces())) GTEST_SKIP() << "no recordings at " << traces() << "; set FORESIGHT_DATA";
  }
};

// What a PDO or an SDO says of the state: bits 0 to 3, 5 and 6 of the statusword.
int masked(const CanFrame& frame, std::size_t at) {
  return (frame.data[at] | frame.data[at + 1] << 8) & 0x6F;
}

TEST_F(RecordedTraces, MaxonEnablesByPdo) {
  const auto recorded = frames_of("maxon_epos_pdo_enable.log");
  ASSERT_EQ(recorded.size(), 9u);
  Wire wire({cia402_drive(2)});
  wire.pass(5ms);
  wire.send(0, {1, 2});
  int answers = 0;
  for (const CanFrame& frame : recorded) {
    if (frame.id == 0x202 || frame.id == 0x602) {
      wire.send(frame);
      continue;
    }
    const auto got = wire.wait(frame.id);
    ASSERT_TRUE(got) << text_of(frame);
    const std::size_t at = frame.id == 0x582 ? 4 : 0;
    EXPECT_EQ(masked(*got, at), masked(frame, at)) << text_of(*got) << " instead of " << text_of(frame);
    EXPECT_TRUE(at == 0 || text_of(*got).substr(0, 12) == text_of(frame).substr(0, 12)) << text_of(*got);
    ++answers;
  }
  EXPECT_EQ(answers, 5);
}

// The SDO answers name the same objects with the same lengths; values where the state is the same.
TEST_F(RecordedTraces, EposAnswersItsStartUp) {
  const auto recorded = frames_of("epos_ros_canopen_259.log");
  ASSERT_GT(recorded.size(), 10u);
  Wire wire({cia402_drive(3)});
  wire.pass(5ms);
  int answers = 0;
  for (const CanFrame& frame : recorded) {
    if (frame.id == 0 || frame.id == 0x603) {
      wire.send(frame);
    } else if (frame.id == 0x703) {
      const auto boot = wire.wait(0x703);
      ASSERT_TRUE(boot);
      EXPECT_EQ(text_of(*boot), text_of(frame));
    } else if (frame.id == 0x583) {
      const auto got = wire.wait(0x583);
      ASSERT_TRUE(got) << text_of(frame);
      EXPECT_EQ(text_of(*got).substr(0, 12), text_of(frame).substr(0, 12)) << "command, index and sub-index";
      ++answers;
    }
  }
  EXPECT_GE(answers, 5);
  EXPECT_TRUE(wire.wait(0x703, 1100ms)) << "the heartbeat that the trace asks for, once a second";
}

TEST_F(RecordedTraces, IngeniaTellsWhatItIs) {
  const auto recorded = frames_of("ingenia_ros2_canopen_36.log");
  ASSERT_GT(recorded.size(), 10u);
  NodeConfig config = cia402_drive(2);
  config.vendor = 0x29C;
  config.product = 0x03B32001;
  Wire wire({config});
  wire.pass(5ms);
  std::vector<std::string> expected;
  for (const CanFrame& frame : recorded)
    if (frame.id == 0x582) expected.push_back(text_of(frame));
  ASSERT_EQ(expected.size(), 4u);
  std::vector<std::string> got;
  for (const CanFrame& frame : recorded) {
    wire.send(frame.id == 0x702 || frame.id == 0x082 || frame.id == 0x582 ? CanFrame{} : frame);
    for (const CanFrame& answer : wire.pass(20ms))
      if (answer.id == 0x582) got.push_back(text_of(answer));
  }
  EXPECT_THAT(expected, testing::Each(testing::AnyOfArray(got)));
}

TEST_F(RecordedTraces, TheMakersDictionaryDrives) {
  const auto file = traces() / "../schunk_canopen/schunk_lwa4d/Schunk_0_63.dcf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  NodeConfig config = cia402_drive(3);
  config.dictionary = file;
  Wire wire({config});
  wire.enable(3);
  EXPECT_EQ(wire.download(3, 0x6060, 0, 8, 1), 0x06090030u) << "6502h says 43h: no cyclic synchronous position";
  EXPECT_EQ(wire.download(3, 0x6060, 0, 7, 1), 0u);
  EXPECT_EQ(wire.download(3, 0x6098, 0, 35, 1), 0x06010002u) << "const";
  EXPECT_EQ(wire.download(3, 0x6060, 0, 1, 1), 0u);
  wire.download(3, 0x607A, 0, 250, 4);
  wire.control(3, 0x1F);
  wire.pass(3s);
  EXPECT_NEAR(wire.shaft().position, 0.25, 1e-3);
}

}  // namespace
}  // namespace foresight::sim::recorded_traces_test
