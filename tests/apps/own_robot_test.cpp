// From somebody else's URDF to a replayed recording, as docs/own-robot.md tells it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/palletiser.hpp"

namespace foresight::own_robot_test {
namespace {

using testing::HasSubstr;

class OwnRobot : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(robots_)) GTEST_SKIP() << "no recorded data at " << robots_ << "; set FORESIGHT_DATA";
  }
  /// The rig of `urdf`, with small pictures: what is tested is not the renderer.
  std::string new_rig(const char* urdf) {
    const std::string rig = (folder_ / "rig.yaml").string();
    const Outcome out = run_program({"rig", "new", "--urdf", (robots_ / urdf).string(), "--out", rig});
    EXPECT_EQ(out.exit_code, 0) << out.err;
    text_ = folder_.read("rig.yaml");
    std::string small = std::regex_replace(text_, std::regex("\\[320, 240\\], rate_hz: 10"), "[80, 60], rate_hz: 5");
    return folder_.write("small.yaml", small).string();
  }
  const std::filesystem::path robots_ = data_folder() / "robots";
  TempFolder folder_;
  std::string text_;
};

TEST_F(OwnRobot, WhatToTryCanBeCopiedToAShell) {
  const std::string rig = (folder_ / "Anna's arm ä.yaml").string();
  const Outcome out =
      run_program({"rig", "new", "--urdf", (source_folder() / "configs/arm.urdf").string(), "--out", rig});
  EXPECT_EQ(out.exit_code, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("Anna'\\''s arm ä.yaml'; foresight robot '"));
}

TEST_F(OwnRobot, AnIiwaIsHomedMovedRecordedAndReplayed) {
  const std::string rig = new_rig("iiwa7/diff_robot_data/kuka_iiwa/urdf/iiwa7.urdf");
  EXPECT_THAT(text_, HasSubstr("7 drives at 250 Hz: 63 % of it"));
  const Outcome again =
      run_program({"rig", "new", "--urdf", (source_folder() / "configs/arm.urdf").string(), "--out", rig});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("is there already"));
  EXPECT_NE(folder_.read("small.yaml"), "") << "and stays";

  const Outcome doctor = run_program({"doctor", rig});
  EXPECT_EQ(doctor.exit_code, 0) << doctor.out;
  EXPECT_THAT(doctor.out, HasSubstr("drive iiwa_joint_7"));

  const std::string motion =
      folder_.write("motion.csv", "time_s,iiwa_joint_2,iiwa_joint_4\n0,0,0\n1,0.3,-0.6\n2,0,0\n").string();
  const std::string run = (folder_ / "run").string();
  const Outcome robot = run_program({"robot", rig, "--stepped", "--home", "--follow", motion, "--record", run, "--log",
                                     (folder_ / "s.log").string()});
  EXPECT_EQ(robot.exit_code, 0) << robot.err << robot.out;
  EXPECT_THAT(robot.err, HasSubstr("follow: done"));

  const Outcome replay = run_program({"replay", run, "--delay-ms", "400", "--report", (folder_ / "r.json").string()});
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_THAT(folder_.read("r.json"), HasSubstr("psnr"));
}

TEST_F(OwnRobot, APandaIsHomedAndMovedWithItsGripper) {
  const std::string rig = new_rig("panda/diff_robot_data/panda_description/urdf/panda.urdf");
  EXPECT_THAT(text_, HasSubstr("panda_finger_joint2 follows panda_finger_joint1"));
  EXPECT_THAT(text_, HasSubstr("bus: bus2, node: 8, unit: m"));
  const std::string motion =
      folder_
          .write(
              "motion.csv",
              "time_s,panda_joint2,panda_joint4,panda_finger_joint1\n0,0,-0.5,0.005\n2,0.3,-1.2,0.03\n4,0,-0.5,0.005\n")
          .string();
  const Outcome robot = run_program({"robot", rig, "--stepped", "--no-cameras", "--home", "--follow", motion});
  EXPECT_EQ(robot.exit_code, 0) << robot.err << robot.out;
  EXPECT_THAT(robot.err, HasSubstr("follow: done"));
}

// Four drives, and joints that follow them and keep the hand level.
TEST(PalletisingArm, IsOperatedByAScript) {
  const TempFolder folder;
  const std::string urdf = folder.write("arm.urdf", palletiser_urdf(Linkage::by_lever)).string();
  const std::string rig = (folder / "rig.yaml").string();
  const Outcome made = run_program({"rig", "new", "--urdf", urdf, "--out", rig});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("wrist_rods follows rear_lever: it has no drive of its own"));
  const std::string small =
      std::regex_replace(folder.read("rig.yaml"), std::regex("\\[320, 240\\], rate_hz: 10"), "[80, 60], rate_hz: 5");
  const Outcome toured =
      run_program({"operator", folder.write("small.yaml", small).string(), "--scripted", "tour", "--delay-ms", "100",
                   "--seconds", "4", "--pictures-hz", "0.5", "--no-zero-delay"});
  EXPECT_EQ(toured.exit_code, 0) << toured.err;
  EXPECT_THAT(toured.out, HasSubstr("succeeded"));
}

// In the machine's own time; stepped time is in tests/robot_devices.
TEST(MockFault, StopsARunningRobotAndIsNamed) {
  TempFolder folder;
  const std::string motion = folder.write("motion.csv", "time_s,elbow\n0,0\n1,0.5\n2,0\n100,0\n").string();
  const std::string rig = (source_folder() / "configs/cia402.yaml").string();
  const Outcome out = run_program({"robot", rig, "--no-cameras", "--follow", motion, "--fault", "elbow:lost_power@2"});
  EXPECT_EQ(out.exit_code, 1) << out.err;
  EXPECT_THAT(out.err, HasSubstr("s: fault lost_power of elbow: its drive has no power"));
  EXPECT_THAT(out.err, testing::AllOf(HasSubstr("follow: "), HasSubstr("elbow")));
  const Outcome late =
      run_program({"robot", rig, "--stepped", "--no-cameras", "--follow",
                   folder.write("short.csv", "time_s,elbow\n0,0\n1,0.2\n").string(), "--fault", "elbow:stuck@9999"});
  EXPECT_THAT(late.err, HasSubstr("fault stuck of elbow at 9999.00 s did not happen"));
  const Outcome wrong = run_program({"robot", rig, "--fault", "elbow:lost@2"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("stuck, following_error, lost_node, noisy_encoder, lost_power"));
}

}  // namespace
}  // namespace foresight::own_robot_test
