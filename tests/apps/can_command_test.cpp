// `foresight can` where there is no hardware, and `foresight bench can`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace foresight::can_command_test {
namespace {

using testing::HasSubstr;

TEST(Can, ScanSaysWhatIsThereAndWhatToType) {
  const Outcome out = run_program({"can", "scan"});
  EXPECT_TRUE(out.exit_code == 0 || out.exit_code == 1) << out.err;
  EXPECT_FALSE(out.out.empty());
  if (out.exit_code == 0) return;
  EXPECT_THAT(out.out, testing::AnyOf(HasSubstr("modprobe"), HasSubstr("ip link set")));
}

TEST(Can, WrongInputIsNamedBeforeAnythingIsOpened) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"can", "send", "can0", "123"}, "no # between identifier and data: '123'"},
      {{"can", "send", "can0", "20000040#00"}, "error frames cannot be sent"},
      {{"can", "dump", "can0", "--filter", "580"}, "--filter: '580' has no colon"},
      {{"can", "dump", "can0", "--filter", "580:1FFFFFFF"}, "mixes 11 and 29 bits"},
      {{"can", "dump", "can0", "--count", "nan"}, "--count"},
      {{"can", "replay", "/nowhere.log", "can0"}, "/nowhere.log: no such file"},
  };
  for (const auto& [arguments, problem] : cases) {
    const Outcome out = run_program(arguments);
    EXPECT_EQ(out.exit_code, 2) << problem;
    EXPECT_THAT(out.last_line(), HasSubstr(problem));
  }
}

class ExplainedLog {
 public:
  explicit ExplainedLog(const std::string& text)
      : file_(std::filesystem::temp_directory_path() / ("foresight-explain-" + std::to_string(getpid()) + ".log")) {
    std::ofstream(file_) << text;
  }
  ~ExplainedLog() { std::filesystem::remove(file_); }
  Outcome as(const char* protocol, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"can", "explain", file_.string(), "--protocol", protocol};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }

 private:
  std::filesystem::path file_;
};

TEST(Can, ExplainSaysEachFrameInWords) {
  const Outcome canopen = ExplainedLog(
                              "(1700000000.123456) can0 000#0102 T\n# a remark\n(1700000000.123556) can0 080#\n"
                              "can0 20000040#0000000000000000\n")
                              .as("cia402");
  EXPECT_EQ(canopen.exit_code, 0) << canopen.err;
  EXPECT_THAT(canopen.out, testing::HasSubstr(": 3 frames in 0.000100 s, the first at 1700000000.123456 (2023-11-14 "
                                              "22:13:20 UTC)\n# can0: 1 NMT, 1 SYNC, 1 error frame\n#   nodes: 2 1\n"
                                              "# 1 errors, 0 frames unknown\n"));
  EXPECT_THAT(canopen.out,
              testing::EndsWith("(0.000000) can0 000#0102 T  NMT start, node 2\n(0.000100) can0 080#  SYNC\n"
                                "(0.000000) can0 20000040#0000000000000000  error frame, class 0x040\n"
                                "3 frames, 0 unknown\n"));
  const Outcome powercube = ExplainedLog("(1.5) can0 0E3#00\n(1.6) can0 100#07\n").as("powercube");
  EXPECT_EQ(powercube.exit_code, 0) << powercube.err;
  EXPECT_THAT(powercube.out, HasSubstr("0E3#00  to module 3: "));
  EXPECT_THAT(powercube.out, HasSubstr("100#07  to all: "));
  EXPECT_THAT(powercube.out, HasSubstr("2 frames, 0 unknown\n"));
}

// A drive that a master sets up, whose process data only that set-up explains; then it faults and starts anew.
const char* const kFaultyDrive =
    "(10.0) arm 603#2300140103020080 T\n"  // RPDO1 off: 1400:01 = 80000203h
    "(10.1) arm 603#2F00160000000000 T\n"  // 1600:00 = 0
    "(10.2) arm 603#2300160110004060 T\n"  // 1600:01 = 6040:00, 16 bits
    "(10.3) arm 603#2300160220007A60 T\n"  // 1600:02 = 607A:00, 32 bits
    "(10.4) arm 603#2F00160002000000 T\n"  // 1600:00 = 2
    "(10.5) arm 603#2300140103020000 T\n"  // RPDO1 on
    "(10.6) arm 603#4041600000000000 T\n(10.7) arm 583#8041600000000206 R\n"
    "(11.0) arm 203#0F00F8FFFFFF T\n"
    "(11.5) arm 183#1802 R\n(11.6) arm 183#1802 R\n"
    "(12.0) arm 083#1023010000000000 R\n(13.0) arm 703#05 R\n(13.5) arm 703#00 R\n(14.0) arm 182#3702 R\n";

TEST(Can, ExplainDecodesProcessDataByTheLogsOwnSetUp) {
  const Outcome out = ExplainedLog(kFaultyDrive).as("cia402");
  EXPECT_EQ(out.exit_code, 0) << out.out;
  EXPECT_THAT(out.out, HasSubstr("(1.000000) arm 203#0F00F8FFFFFF T  RPDO1 to node 3: 6040:00 controlword = 0x000F "
                                 "(enable operation); 607A:00 target position = 0xFFFFFFF8 (-8)\n"));
  EXPECT_THAT(out.out, HasSubstr("#   nodes: 2 1, 3 14\n"));
}

TEST(Can, ExplainShowsWhatIsAskedFor) {
  const ExplainedLog log(kFaultyDrive);
  const Outcome errors = log.as("cia402", {"--errors"});
  EXPECT_THAT(errors.out, HasSubstr("\n# 4 errors, 0 frames unknown\n"));
  for (const char* words :
       {"(0.700000) arm 583#8041600000000206 R  SDO answer of node 3: abort", "(1.500000) arm 183#1802",
        "(2.000000) arm 083#", "(3.500000) arm 703#00 R  boot-up of node 3"})
    EXPECT_THAT(errors.out, HasSubstr(words));
  for (const char* words : {"(1.600000)", "(3.000000)", "controlword"})
    EXPECT_THAT(errors.out, testing::Not(HasSubstr(words))) << "the same fault again, and what is well";
  const Outcome part = log.as("cia402", {"--node", "3", "--from", "1", "--to", "2.0", "--absolute"});
  EXPECT_THAT(part.out, HasSubstr("(0000000011.000000) arm 203#"));
  EXPECT_THAT(part.out, testing::Not(HasSubstr("(0000000010.")));
  EXPECT_THAT(part.out, testing::Not(HasSubstr("(0000000013.")));
  EXPECT_THAT(log.as("cia402", {"--from", "2", "--to", "1"}).last_line(), HasSubstr("--from: lies behind --to"));
}

// Every start of mock drives, and of real ones that get power with the program.
TEST(Can, ExplainTakesNoStartForAnError) {
  const char* const start =
      "(5.0) arm 601#4000100000000000 T\n(5.01) arm 701#00 R\n(5.3) arm 601#8000100000000405 T\n"
      "(5.4) arm 601#4000100000000000 T\n(5.41) arm 581#4300100092010200 R\n"
      "(5.5) arm 000#8101 T\n(5.6) arm 701#00 R\n";
  EXPECT_THAT(ExplainedLog(start).as("cia402").out, HasSubstr("\n# 0 errors, 0 frames unknown\n"));
  // It had booted, had been asked, and then says nothing; later it boots by itself.
  const Outcome silent = ExplainedLog(std::string(start) +
                                      "(5.7) arm 601#4000100000000000 T\n(6.0) arm 601#8000100000000405 T\n"
                                      "(6.1) arm 701#05 R\n(6.2) arm 701#00 R\n")
                             .as("cia402", {"--errors"});
  EXPECT_THAT(silent.out, HasSubstr("\n# 2 errors, 0 frames unknown\n"));
  EXPECT_THAT(silent.out, HasSubstr("(1.000000) arm 601#80"));
  EXPECT_THAT(silent.out, HasSubstr("(1.200000) arm 701#00"));
}

// A received frame is logged when it is read, with the instant at which it came.
TEST(Can, ExplainCountsTimeFromTheFirstFrameOnTheBus) {
  const Outcome out = ExplainedLog("(7.5) arm 080# T\n(7.25) arm 701#05 R\n(8.0) arm 080# T\n").as("cia402");
  EXPECT_THAT(out.out, HasSubstr("3 frames in 0.750000 s, the first at 7.250000"));
  EXPECT_THAT(out.out, HasSubstr("(0.250000) arm 080#"));
  EXPECT_THAT(out.out, HasSubstr("(0.000000) arm 701#05"));
}

TEST(Can, ExplainTakesProtocolAndNamesFromTheRig) {
  const auto file =
      std::filesystem::temp_directory_path() / ("foresight-explain-rig-" + std::to_string(getpid()) + ".log");
  std::ofstream(file) << "(1) arm 0E3#00\n(1) head 0E1#00\n";
  const std::string minerva = (source_folder() / "configs/minerva.yaml").string();
  const auto explain = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"can", "explain", file.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  };
  const Outcome out = explain({"--rig", minerva});
  EXPECT_THAT(out.out, HasSubstr("arm 0E3#00  upper_arm_roll: to module 3: "));
  EXPECT_THAT(out.out, HasSubstr("head 0E1#00  pan: to module 1: "));
  EXPECT_THAT(out.out, HasSubstr("#   nodes: 3 (upper_arm_roll) 1\n"));
  EXPECT_THAT(explain({}).last_line(), HasSubstr("give the rig with --rig, or say --protocol"));
  EXPECT_THAT(explain({"--rig", minerva, "--protocol", "powercube"}).last_line(), HasSubstr("leave one out"));
  std::ofstream(file) << "(1) can7 0E3#00\n";
  EXPECT_THAT(explain({"--rig", minerva}).last_line(), HasSubstr("no bus of it has the log's interface 'can7'"));
  std::filesystem::remove(file);
}

TEST(Can, ExplainUsesTheNamesOfDataSheets) {
  const auto sheet = [](const char* name, const std::string& object) {
    const auto file = std::filesystem::temp_directory_path() / (name + std::to_string(getpid()));
    std::ofstream(file) << "[OptionalObjects]\nSupportedObjects=1\n1=0x6064\n[6064]\nParameterName=" << object
                        << "\nDataType=4\nAccessType=ro\n";
    return file.string();
  };
  const std::string axis = sheet("foresight-axis-eds-", "Shaft angle"), grip = sheet("foresight-grip-eds-", "Opening");
  const ExplainedLog log("(1) can0 602#4064600000000000\n(1) can0 60C#4064600000000000\n");
  const Outcome out = log.as("cia402", {"--eds", axis, "--eds", "12=" + grip});
  EXPECT_EQ(out.exit_code, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("SDO request to node 2: upload 6064:00 Shaft angle\n"));
  EXPECT_THAT(out.out, HasSubstr("SDO request to node 12: upload 6064:00 Opening\n"));
  EXPECT_THAT(log.as("cia402").out, HasSubstr("upload 6064:00 actual position\n"));
  EXPECT_THAT(log.as("powercube", {"--eds", axis}).last_line(), HasSubstr("--eds: there are none with powercube"));
  EXPECT_THAT(log.as("cia402", {"--eds", "/nowhere.eds"}).last_line(), HasSubstr("/nowhere.eds: no such file"));
  EXPECT_THAT(log.as("cia402", {"--eds", "200=" + axis}).last_line(), HasSubstr("node id 200"));
  EXPECT_THAT(log.as("cia402", {"--eds", axis, "--eds", grip}).last_line(), HasSubstr("is a second one"));
  std::filesystem::remove(axis);
  std::filesystem::remove(grip);
}

TEST(Can, ExplainKnowsTheSchunkMotionProtocol) {
  const Outcome out = ExplainedLog("(1) can0 501#05B000002041\n(1) can0 701#028874\n").as("schunk-motion");
  EXPECT_EQ(out.exit_code, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("  to module 1: move to position 10\n"));
  EXPECT_THAT(out.out, HasSubstr("  module 1: error 0x74 ERROR MOTOR VOLTAGE LOW\n2 frames, 0 unknown\n"));
}

TEST(Can, ExplainCountsWhatItDoesNotKnow) {
  // A 29-bit identifier, an SDO of three bytes, one with a command that there is not, and a heartbeat.
  const ExplainedLog log("(1) can0 1F334455#11\n(1) can0 583#010203\n(1) can0 603#E000000000000000\n(1) can0 703#05\n");
  const Outcome out = log.as("cia402");
  EXPECT_EQ(out.exit_code, 1);
  EXPECT_THAT(out.out, HasSubstr("703#05  heartbeat of node 3: operational\n4 frames, 3 unknown\n"));
  EXPECT_THAT(log.as("powercube").out, HasSubstr("4 frames, 4 unknown\n"));
}

TEST(Can, ExplainNamesTheLineThatIsNoFrame) {
  const Outcome out = ExplainedLog("(1) can0 080#\n(1) can0 08\n").as("cia402");
  EXPECT_EQ(out.exit_code, 2);
  EXPECT_THAT(out.last_line(), HasSubstr(":2: "));
}

TEST(Can, BenchMeetsTheLimit) {
  const auto file =
      std::filesystem::temp_directory_path() / ("foresight-bench-can-" + std::to_string(getpid()) + ".json");
  const Outcome out = run_program({"bench", "can", "--json", file.string()});
  EXPECT_EQ(out.exit_code, 0) << out.out;
  const auto all = nlohmann::json::parse(std::ifstream(file));
  std::filesystem::remove(file);
  EXPECT_LT(all["share_of_core_on_full_bus"], 0.05);
  EXPECT_NEAR(all["wire_frames_per_second"]["shortest"], 1e6 / 47, 1);
}

}  // namespace
}  // namespace foresight::can_command_test
