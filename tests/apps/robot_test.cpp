// `foresight robot` and `foresight doctor` on mock rigs, and where devices are missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {
namespace {

using testing::HasSubstr;

std::string config(const std::string& name) {
  return std::string(FORESIGHT_SOURCE_DIR) + "/configs/" + name;
}

class Robot : public testing::TestWithParam<const char*> {
 protected:
  std::string motion() const {
    return folder_.write("motion.csv", "time_s,elbow,pan,finger\n0,0.2,0,0.01\n1,0.6,0.5,0.02\n2,0.2,0,0.01\n")
        .string();
  }
  TempFolder folder_;
};

TEST_P(Robot, FollowsAFileOnMockDrives) {
  const Outcome out = run_program({"robot", config(GetParam()), "--stepped", "--home", "--follow", motion(), "--log",
                                   (folder_ / "s.log").string()});
  EXPECT_EQ(out.exit_code, 0) << out.err << out.out;
  EXPECT_THAT(out.err, HasSubstr("follow: done"));
  EXPECT_GT(std::filesystem::file_size(folder_ / "s-arm.log"), 100'000u);
  EXPECT_GT(std::filesystem::file_size(folder_ / "s-head.log"), 10'000u);
}

TEST_P(Robot, DoesNotHomeWithoutConsent) {
  if (std::string(GetParam()) == "cia402.yaml") GTEST_SKIP() << "its encoders are absolute: nothing is to be homed";
  const Outcome out = run_program({"robot", config(GetParam()), "--stepped", "--follow", motion()});
  EXPECT_EQ(out.exit_code, 1);
  EXPECT_THAT(out.err, HasSubstr("give --home"));
}

TEST_P(Robot, StopsUnderControlWhenItIsTerminated) {
  Program program({"robot", config(GetParam()), "--home", "--follow", motion()});
  std::this_thread::sleep_for(std::chrono::seconds(4));
  if (!program.running()) {
    const Outcome out = program.wait();
    EXPECT_EQ(out.exit_code, 1);
    EXPECT_THAT(out.err, HasSubstr("stopped: ")) << "nothing else may end it";
    GTEST_SKIP() << "this machine is too busy for real time: " << out.last_line();
  }
  kill(program.pid(), SIGTERM);
  const Outcome out = program.wait();
  EXPECT_EQ(out.exit_code, 1) << "the motion was not finished";
  EXPECT_THAT(out.out, HasSubstr("disabled")) << "brakes closed";
  EXPECT_THAT(out.err, HasSubstr("interrupted"));
}

TEST_P(Robot, DoctorFindsItsDrives) {
  const Outcome out = run_program({"doctor", config(GetParam())});
  EXPECT_EQ(out.exit_code, 0) << out.out;
  EXPECT_THAT(out.out, HasSubstr("drive shoulder_yaw"));
  EXPECT_THAT(out.out, HasSubstr("its drives will fill"));
}

INSTANTIATE_TEST_SUITE_P(Rigs, Robot, testing::Values("minerva.yaml", "cia402.yaml"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find('.')); });

class RobotInput : public testing::Test {
 protected:
  std::string rig_with(const std::string& what, const std::string& instead) {
    std::ifstream stream(config("cia402.yaml"));
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + instead.size()))
      text.replace(at, what.size(), instead);
    std::filesystem::copy_file(config("arm.urdf"), folder_ / "arm.urdf",
                               std::filesystem::copy_options::overwrite_existing);
    return folder_.write("rig.yaml", text).string();
  }
  TempFolder folder_;
};

TEST_F(RobotInput, WrongInputIsNamed) {
  const auto expect = [](const std::vector<std::string>& arguments, const char* words) {
    const Outcome out = run_program(arguments);
    EXPECT_EQ(out.exit_code, 2) << out.err;
    EXPECT_THAT(out.last_line(), HasSubstr(words));
  };
  expect({"robot"}, "RIG is required");
  expect({"robot", "/nowhere.yaml"}, "/nowhere.yaml");
  expect({"robot", config("cia402.yaml"), "--follow", "/nowhere.csv"}, "/nowhere.csv");
  expect({"robot", rig_with("velocity:", "velocty:")}, "velocty");
  expect({"robot", rig_with("bit_rate: 1000000", "bit_rate: 250000")}, "more than 70 %");
  expect({"robot", rig_with("interface: mock", "interface: can9"), "--stepped"}, "--mock");
  expect({"doctor", "/nowhere.yaml"}, "/nowhere.yaml");
  const auto rack = folder_.write("rack.yaml", "drives:\n  - {name: a, kind: cia402, node: 1, serial: -3}\n");
  expect({"sim", "drives", "--can", "vcan0", "--rack", rack.string()}, "-3 is no identity number");
}

TEST_F(RobotInput, MissingDevicesAreNamed) {
  const std::string rig = rig_with("interface: mock", "interface: can9");
  const Outcome robot = run_program({"robot", rig, "--check"});
  EXPECT_NE(robot.exit_code, 0);
  EXPECT_THAT(robot.last_line(), HasSubstr("can9"));
  const Outcome doctor = run_program({"doctor", rig});
  EXPECT_EQ(doctor.exit_code, 1);
  EXPECT_THAT(doctor.out, HasSubstr("BAD   bus arm"));
}

TEST_F(RobotInput, DoctorIsUsefulWithoutAnyHardware) {
  const Outcome out = run_program({"doctor"});
  EXPECT_EQ(out.exit_code, 0) << out.out;
  for (const char* words : {"CAN", "cameras", "real-time priority", "OpenGL", "network buffers"})
    EXPECT_THAT(out.out, HasSubstr(words));
}

}  // namespace
}  // namespace foresight
