// `foresight robot` and `foresight doctor` on mock rigs, and where devices are missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/terminal.hpp"

namespace foresight::robot_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string config(const std::string& name) {
  return (source_folder() / "configs" / name).string();
}

std::string with_small_cameras(const std::string& name, const TempFolder& folder) {
  return small_rig(name, folder, "80, 60");
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
  const Outcome out = run_program({"robot", with_small_cameras(GetParam(), folder_), "--stepped", "--home", "--follow",
                                   motion(), "--log", (folder_ / "s.log").string()});
  EXPECT_EQ(out.exit_code, 0) << out.err << out.out;
  EXPECT_THAT(out.err, HasSubstr("follow: done"));
  EXPECT_GT(std::filesystem::file_size(folder_ / "s-arm.log"), 100'000u);
  EXPECT_GT(std::filesystem::file_size(folder_ / "s-head.log"), 10'000u);
}

TEST_P(Robot, DoesNotHomeWithoutConsent) {
  if (std::string(GetParam()) == "cia402.yaml") GTEST_SKIP() << "its encoders are absolute: nothing is to be homed";
  const Outcome out =
      run_program({"robot", with_small_cameras(GetParam(), folder_), "--stepped", "--follow", motion()});
  EXPECT_EQ(out.exit_code, 1);
  EXPECT_THAT(out.err, HasSubstr("give --home"));
}

// Ctrl-S, or a line of ssh that stalls: where the program waited for it, nothing would stop the robot any more.
TEST(RobotTerminal, StopsThoughItsTerminalTakesNoOutput) {
  Terminal terminal;
  const termios before = terminal.modes();
  Program robot({"robot", config("cia402.yaml"), "--mock", "--no-cameras"}, {.shell = terminal.redirection()});
  std::string shown;
  while (robot.running() && shown.find("enabled") == std::string::npos) {
    shown += terminal.shown();
    if (shown.find("disabled") != std::string::npos) terminal.type("e");
  }
  const termios during = terminal.modes();
  EXPECT_EQ(during.c_lflag, before.c_lflag & ~static_cast<tcflag_t>(ICANON | ECHO)) << "Ctrl-C is a signal";
  EXPECT_EQ(during.c_iflag, before.c_iflag);
  EXPECT_EQ(during.c_oflag, before.c_oflag);
  EXPECT_EQ(during.c_cflag, before.c_cflag);
  terminal.type("\x13");
  while (!terminal.shown().empty()) {
  }
  robot.interrupt(SIGTERM);
  EXPECT_EQ(robot.wait(std::chrono::seconds(60)).exit_code, 130) << "137: killed, since it did not end";
  EXPECT_EQ(terminal.modes().c_lflag, before.c_lflag);
}

TEST(RobotMotion, WhatTheGateHoldsBackEndsAsNotReached) {
  TempFolder folder;
  const auto down = folder.write("down.csv", "time_s,shoulder_pitch,elbow\n0,0,0\n4,1.9,1.2\n");
  const Outcome out =
      run_program({"robot", config("cia402.yaml"), "--stepped", "--no-cameras", "--follow", down.string()});
  EXPECT_EQ(out.exit_code, 1);
  EXPECT_THAT(out.err, HasSubstr("robot: 10 of 10 links guarded by their visual shapes"));
  EXPECT_THAT(out.err, HasSubstr("follow: not reached: joint "));
  EXPECT_THAT(out.err, HasSubstr("comes too close to obstacle 'table'"));
}

// In stepped time, so that nothing but the signal can end it. How far it came is counted by what it wrote down.
TEST_P(Robot, StopsUnderControlWhenItIsTerminated) {
  const std::string endless =
      folder_.write("endless.csv", "time_s,elbow,pan\n0,0.2,0\n1,0.6,0.5\n1000000,0.6,0.5\n").string();
  for (const double written : {0.3e6, 20e6}) {  // while it homes, where it has to; while it follows
    const auto log = folder_ / ("s" + std::to_string(static_cast<int>(written)) + ".log");
    auto arm = log;
    arm.replace_extension().concat("-arm.log");
    Program program({"robot", config(GetParam()), "--stepped", "--no-cameras", "--home", "--follow", endless, "--log",
                     log.string()});
    std::error_code none;
    while (program.running() &&
           (!std::filesystem::exists(arm) || static_cast<double>(std::filesystem::file_size(arm, none)) < written))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ASSERT_TRUE(program.running()) << program.wait().err;
    kill(program.pid(), SIGTERM);
    const Outcome out = program.wait();
    EXPECT_EQ(out.exit_code, 130);
    EXPECT_THAT(out.out, HasSubstr(": disabled")) << "brakes closed";
    EXPECT_THAT(out.out, HasSubstr(" 0 overruns"));
    EXPECT_THAT(out.err, HasSubstr("robot: stopped by SIGTERM: drives and cameras end"));
    EXPECT_THAT(out.err, HasSubstr("follow: interrupted")) << "and no stop of the gate's";
  }
}

TEST_P(Robot, DoctorFindsItsDrives) {
  const Outcome out = run_program({"doctor", with_small_cameras(GetParam(), folder_)});
  EXPECT_EQ(out.exit_code, 0) << out.out;
  EXPECT_THAT(out.out,
              testing::ContainsRegex("drive shoulder_yaw +answers as node [0-9]+ .*product: 0x.*, serial: [0-9]+"));
  EXPECT_THAT(out.out, HasSubstr("its drives will fill"));
}

TEST_P(Robot, RecordsWhatItsMockCamerasSee) {
  const std::string rig = with_small_cameras(GetParam(), folder_), out = (folder_ / "run").string();
  const Outcome robot = run_program({"robot", rig, "--stepped", "--home", "--follow", motion(), "--record", out});
  ASSERT_EQ(robot.exit_code, 0) << robot.err << robot.out;
  EXPECT_THAT(robot.out, testing::ContainsRegex("cameras: [45] pairs/s"));
  EXPECT_THAT(robot.err, HasSubstr(" pairs\n"));
  EXPECT_THAT(robot.err, Not(HasSubstr("dropped"))) << "time waits for the disk";
  EXPECT_GT(std::filesystem::file_size(folder_ / "run-can-arm.log"), 100'000u);
  const Outcome followed = run_program(
      {"robot", rig, "--stepped", "--home", "--no-cameras", "--follow", (folder_ / "run-joints.csv").string()});
  EXPECT_THAT(followed.last_line(), Not(HasSubstr("run-joints.csv"))) << "can be read as a motion";
  const Outcome replay = run_program({"replay", out, "--delay-ms", "400"});
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
}

TEST_P(Robot, CompletesItsRecordingThoughNothingElseCanBeWritten) {
  const std::string out = (folder_ / "run").string();
  const Outcome robot = run_program({"robot", with_small_cameras(GetParam(), folder_), "--stepped", "--home",
                                     "--follow", motion(), "--record", out, "--session-html", "/dev/full"});
  EXPECT_EQ(robot.exit_code, 1);
  EXPECT_THAT(robot.last_line(), HasSubstr("/dev/full"));
  EXPECT_EQ(run_program({"replay", out, "--delay-ms", "400"}).exit_code, 0);
}

// What is judged is counted: a busy machine only makes it take longer. The drives stay without power, as a machine that
// is late may rightly be stopped by the gate; how they move is judged in stepped time, above.
TEST_P(Robot, RunsItsCamerasInRealTime) {
  const auto run = folder_ / "run";
  Program program({"robot", with_small_cameras(GetParam(), folder_), "--record", run.string()});
  const auto recorded = [&] {  // written under another name until the run is complete
    std::size_t images = 0;
    std::error_code none;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path(), none))
      images += entry.path().extension() == ".png";
    return images;
  };
  while (program.running() && recorded() < 8) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(program.running()) << program.wait().err;
  kill(program.pid(), SIGTERM);
  const Outcome out = program.wait();
  EXPECT_EQ(out.exit_code, 130) << out.err << out.out;
  EXPECT_THAT(out.out, testing::ContainsRegex("cameras: [0-9]+ pairs/s"));
  EXPECT_THAT(out.out, HasSubstr(": disabled"));
  EXPECT_THAT(out.err, testing::ContainsRegex("[0-9]+ pairs"));
  EXPECT_GE(recorded(), 8u);
  EXPECT_TRUE(std::filesystem::exists(run / "camera.yaml")) << "the recording was completed";
}

INSTANTIATE_TEST_SUITE_P(Rigs, Robot, testing::Values("minerva.yaml", "cia402.yaml"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find('.')); });

const std::string kPlace = "T_left_right: {xyz: [0.065, 0, 0]}\n";

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
  const Outcome line = run_program({"doctor", rig_with("robot:", "link: {interface: lan9}\nrobot:")});
  EXPECT_THAT(line.out, testing::ContainsRegex("BAD   link +.*lan9"));
}

TEST_F(RobotInput, ACheckedRobotThatStandsInSomethingAtHomeIsAnError) {
  const Outcome fine = run_program({"robot", rig_with("no such words", ""), "--check"});
  EXPECT_EQ(fine.exit_code, 0) << fine.err;
  const Outcome out =
      run_program({"robot", rig_with("-0.46, -0.50, -0.03, 0.46, 0.78, 0.0", "-1, -1, 0, 1, 1, 1"), "--check"});
  EXPECT_EQ(out.exit_code, 1);
  EXPECT_THAT(out.err, HasSubstr("'table'"));
  EXPECT_THAT(out.last_line(), HasSubstr("from home"));
}

TEST_F(RobotInput, CamerasOfTheRigAreChecked) {
  for (const char* side : {"left", "right"}) {
    std::filesystem::create_directory(folder_ / side);
    for (int i = 0; i < 3; ++i)
      cv::imwrite((folder_ / side / ("image_" + std::to_string(i) + ".png")).string(),
                  cv::Mat(12, 16, CV_8UC3, cv::Scalar::all(9)));
  }
  const std::string mock = "{driver: mock, size_px: [320, 240], rate_hz: 10, exposure_s: 0.008}";
  std::string rig = rig_with("  left: " + mock, "  left: {driver: images, device: left, rate_hz: 20}");
  EXPECT_THAT(run_program({"doctor", rig}).last_line(), HasSubstr("another world"));
  std::string text = folder_.read("rig.yaml");
  text.replace(text.find("right: " + mock), mock.size() + 7, "right: {driver: images, device: right, rate_hz: 20}");
  rig = folder_.write("rig.yaml", text).string();
  const Outcome fine = run_program({"doctor", rig});
  EXPECT_EQ(fine.exit_code, 0) << fine.out;
  // How many come within the time that the doctor looks is a matter of the machine.
  EXPECT_THAT(fine.out, testing::ContainsRegex("camera left +16 x 12 bgr, [0-9]+\\.[0-9] images per second"));
  EXPECT_THAT(fine.out, testing::ContainsRegex("camera pair +[0-9]+\\.[0-9] pairs per second"));
  std::filesystem::remove_all(folder_ / "right");
  const Outcome broken = run_program({"doctor", rig});
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_THAT(broken.out, testing::ContainsRegex("BAD   camera right .*right"));
}

TEST_F(RobotInput, RecordingNeedsCameras) {
  const std::string out = (folder_ / "run").string();
  EXPECT_THAT(run_program({"robot", config("cia402.yaml"), "--no-cameras", "--record", out}).last_line(),
              HasSubstr("--no-cameras"));
  const std::string lensless =
      rig_with("driver: mock, size_px: [320, 240], rate_hz: 10, exposure_s: 0.008", "driver: images, device: left");
  EXPECT_THAT(run_program({"robot", lensless, "--record", out}).last_line(), HasSubstr("same device"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(RobotInput, RecordTakesTheCamerasOfARig) {
  const std::string out = (folder_ / "run").string();
  const Outcome recorded =
      run_program({"record", out, "--rig", with_small_cameras("cia402.yaml", folder_), "--count", "3"});
  EXPECT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_THAT(recorded.err, HasSubstr("3 pairs"));
  EXPECT_THAT(folder_.read("run/camera.yaml"), HasSubstr("image_width: 80"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run" / "nodes.txt"));
  EXPECT_THAT(
      run_program({"record", out, "--rig", config("cia402.yaml"), "--left", "/dev/video0", "--right", "x"}).last_line(),
      HasSubstr("beside other cameras"));
}

TEST_F(RobotInput, LibcameraIsAskedForByName) {
  const Outcome out =
      run_program({"record", (folder_ / "run").string(), "--left", "libcamera:no-such-camera", "--right",
                   "libcamera:nor-this", "--camera", folder_.write("l.yaml", kCamera).string(), "--camera-right",
                   folder_.write("r.yaml", kCamera + kPlace).string()});
  EXPECT_NE(out.exit_code, 0);
  EXPECT_THAT(out.last_line(), testing::AnyOf(HasSubstr("libcamera knows no such camera"),
                                              HasSubstr("install libcamera-dev and rebuild")));
}

TEST_F(RobotInput, DoctorIsUsefulWithoutAnyHardware) {
  const Outcome out = run_program({"doctor"});
  EXPECT_EQ(out.exit_code, 0) << out.out;
  EXPECT_THAT(out.err, testing::Not(HasSubstr("WARN"))) << "of libraries that look for hardware";
  for (const char* words : {"CAN", "cameras", "real-time priority", "OpenGL", "network buffers"})
    EXPECT_THAT(out.out, HasSubstr(words));
}

}  // namespace
}  // namespace foresight::robot_test
