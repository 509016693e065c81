#include "drivers/canopen/describe.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "drivers/canopen/eds_reader.hpp"
#include "frames.hpp"
#include "recorded.hpp"

namespace foresight::canopen::describe_test {
namespace {

// The recordings and what their posters say of each frame.
struct Trace {
  const char* file;
  std::vector<const char*> meanings;  // one a frame
};
const Trace kTraces[] = {
    {"abb_cm588_boot.log",
     {"boot-up of node 10", "EMCY of node 10: 0x0000 no error, error register 0x00", "NMT start, node 10"}},
    {"epos_ros_canopen_259.log",
     {"NMT reset communication, node 3", "boot-up of node 3",
      "EMCY of node 3: 0x81B0 communication, error register 0x01 (generic)",
      "EMCY of node 3: 0x81A0 communication, error register 0x01 (generic)",
      "SDO request to node 3: download 1017:00 producer heartbeat time = 0x03E8 (1000 ms)",
      "SDO answer of node 3: download 1017:00 producer heartbeat time done",
      "SDO request to node 3: upload 6041:00 statusword",
      "SDO answer of node 3: upload 6041:00 statusword = 0x0218 (fault)",
      "SDO request to node 3: upload 6061:00 mode of operation shown",
      "SDO answer of node 3: upload 6061:00 mode of operation shown = 1 (profile position)",
      "SDO request to node 3: upload 6064:00 actual position",
      "SDO answer of node 3: upload 6064:00 actual position = 0x000011FF (4607)",
      "SDO request to node 3: upload 6040:00 controlword",
      "SDO answer of node 3: upload 6040:00 controlword = 0x0000 (disable voltage)",
      "SDO request to node 3: upload 6060:00 mode of operation"}},
    {"ingenia_ros2_canopen_36.log",
     {"boot-up of node 1",
      "NMT reset communication, all nodes",
      "SDO request to node 2: upload 1000:00 device type",
      "SYNC",
      "SYNC",
      "SDO request to node 2: abort 1000:00 device type, 0x05040000 SDO protocol timed out",
      "SDO request to node 2: upload 1000:00 device type",
      "SYNC",
      "SYNC",
      "SDO request to node 2: abort 1000:00 device type, 0x05040000 SDO protocol timed out",
      "SYNC",
      "SYNC",
      "boot-up of node 2",
      "SDO answer of node 2: upload 1000:00 device type = 0x00020192 (profile 402)",
      "EMCY of node 2: 0x8110 CAN overrun (objects lost), error register 0x11 (generic, communication)",
      "EMCY of node 2: 0x8110 CAN overrun (objects lost), error register 0x11 (generic, communication)",
      "SDO answer of node 2: upload 1000:00 device type = 0x00020192 (profile 402)",
      "SYNC",
      "SDO request to node 2: upload 1018:01 vendor id",
      "SDO answer of node 2: upload 1018:01 vendor id = 0x0000029C",
      "SDO request to node 2: upload 1018:02 product code",
      "SDO answer of node 2: upload 1018:02 product code = 0x03B32001",
      "SDO request to node 2: upload 6040:00 controlword"}},
    {"maxon_epos_pdo_enable.log",
     {"TPDO1 of node 2: 40 07, as status word: switch on disabled, target reached",
      "RPDO1 to node 2: 06 00, as control word: shutdown",
      "TPDO1 of node 2: 21 07, as status word: ready to switch on, target reached",
      "RPDO1 to node 2: 07 00, as control word: switch on",
      "TPDO1 of node 2: 23 07, as status word: switched on, target reached",
      "RPDO1 to node 2: 0F 00, as control word: enable operation",
      "TPDO1 of node 2: 37 07, as status word: operation enabled, target reached",
      "SDO request to node 2: upload 6041:00 statusword",
      "SDO answer of node 2: upload 6041:00 statusword = 0x0737 (operation enabled, target reached)"}},
};

TEST(Describe, RecordedTraces) {
  const auto folder = recorded("can/cia402_traces");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recorded traces at " << folder << "; set FORESIGHT_DATA";
  for (const Trace& trace : kTraces) {
    std::ifstream in(folder / trace.file);
    ASSERT_TRUE(in) << trace.file;
    std::size_t i = 0;
    for (std::string line; std::getline(in, line);) {
      const std::size_t hash = line.find('#');
      if (line.empty() || hash == 0) continue;
      while (line.back() == '\r' || line.back() == ' ') line.pop_back();
      ASSERT_LT(i, trace.meanings.size()) << trace.file;
      EXPECT_EQ(describe(frame(line.substr(line.rfind(' ') + 1))), trace.meanings[i++]) << trace.file << ": " << line;
    }
    EXPECT_EQ(i, trace.meanings.size()) << trace.file;
  }
}

TEST(Describe, OtherServices) {
  const std::pair<const char*, const char*> kCases[] = {
      {"080#05", "SYNC, counter 5"},
      {"100#112233445566", "TIME 11 22 33 44 55 66"},
      {"77F#05", "heartbeat of node 127: operational"},
      {"000#8100", "NMT reset node, all nodes"},
      {"000#99", "unknown"},
      {"000#0190", "unknown"},
      {"703#42", "unknown"},
      {"600#4000100000000000", "unknown"},
      {"7E5#0400000000000000", "unknown"},
      {"583#410810000A000000", "SDO answer of node 3: upload 1008:00, 10 bytes follow"},
      {"603#7000000000000000", "SDO request to node 3: upload next segment, toggle 1"},
      {"583#19484950FFFFFFFF", "SDO answer of node 3: upload segment 48 49 50, toggle 1, last"},
      {"603#0001020304050607", "SDO request to node 3: download segment 01 02 03 04 05 06 07, toggle 0"},
      {"583#3000000000000000", "SDO answer of node 3: download segment taken, toggle 1"},
      {"583#8016100000000206",
       "SDO answer of node 3: abort 1016:00 consumer heartbeat time, 0x06020000 the object does not exist"},
      {"583#80", "SDO answer of node 3: malformed, 1 bytes"},
      {"482#0102", "TPDO4 of node 2: 01 02"},
      {"502#0102", "RPDO4 to node 2: 01 02"},
      {"402#", "RPDO3 to node 2: no data"},
      {"082#1086010000000000", "EMCY of node 2: 0x8610 monitoring, error register 0x01 (generic)"},
      {"082#1186010000000000", "EMCY of node 2: 0x8611 following error, error register 0x01 (generic)"},
      {"082#10FF000000000000", "EMCY of node 2: 0xFF10 device specific, error register 0x00"},
  };
  for (const auto& [text, meaning] : kCases) EXPECT_EQ(describe(frame(text)), meaning) << text;
  CanFrame extended = frame("080#");
  extended.extended = true;
  EXPECT_EQ(describe(extended), "unknown");
}

TEST(Describe, KnownPdosAndObjects) {
  const Pdo pdos[] = {Pdo(PdoDirection::from_node, 1, 2, 0x182, 1, {{0x6041, 0, 16, false}, {0x6064, 0, 32, true}})};
  const auto objects = parse_eds(
      "[MandatoryObjects]\nSupportedObjects=1\n1=0x6064\n[6064]\nParameterName=Where it "
      "is\nDataType=4\nAccessType=ro\n",
      "a.eds", 2);
  const Vocabulary words{&objects, pdos};
  EXPECT_EQ(describe(frame("182#3704FEFFFFFF"), words),
            "TPDO1 of node 2: 6041:00 statusword = 0x0437 (operation enabled, target reached); 6064:00 Where it is = "
            "0xFFFFFFFE (-2)");
  EXPECT_EQ(describe(frame("182#3704"), words), "TPDO1 of node 2: 37 04, too short");
}

TEST(Describe, SaysSomethingOfEveryFrame) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    CanFrame f;
    f.id = random() % 0x800;
    f.size = static_cast<std::uint8_t>(random() % 9);
    for (int b = 0; b < 8; ++b) f.data[static_cast<std::size_t>(b)] = static_cast<std::uint8_t>(random());
    EXPECT_FALSE(describe(f).empty());
  }
}

}  // namespace
}  // namespace foresight::canopen::describe_test
