// `foresight robot --serve` and `foresight link`, in a network of the test's own.
#include <thread>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/private_network.hpp"

namespace foresight {
namespace {

using testing::HasSubstr;

class Link : public PrivateNetworkTest {
 protected:
  static std::string rig() { return (source_folder() / "configs" / "minerva.yaml").string(); }
};

// A robot whose drives are not enabled tells its state; who looks at it sees program, topics and messages.
TEST_F(Link, ARunningRobotIsSeenAndReadAndNamesAreHelpedWith) {
  Program robot({"robot", rig(), "--mock", "--no-cameras", "--serve"});
  const Outcome state = run_program({"link", "listen", "/foresight/robot_state", "--count", "2"});
  EXPECT_EQ(state.exit_code, 0) << state.err;
  EXPECT_THAT(state.out, HasSubstr("rig: 'minerva'\nphase:\n  label: 'disabled'"));
  const Outcome status = run_program({"link", "status", "--rig", rig(), "--seconds", "1"});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_THAT(status.out, HasSubstr("robot minerva, on "));
  EXPECT_THAT(status.out, HasSubstr("  writes rt/joint_states (sensor_msgs/msg/JointState)"));
  const Outcome rate = run_program({"link", "rate", "foresight/robot_state", "--seconds", "1"});
  EXPECT_EQ(rate.exit_code, 0) << rate.err;
  EXPECT_THAT(rate.out, HasSubstr("rt/foresight/robot_state (foresight_msgs/msg/RobotState)\nrate "));
  const Outcome kept = run_program({"link", "listen", "tf_static", "--count", "1"});
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("child_frame_id: 'stand'"));
  const Outcome misspelt = run_program({"link", "listen", "joint_stats"});
  EXPECT_EQ(misspelt.exit_code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("did you mean 'rt/joint_states'?"));
  robot.interrupt();
  const Outcome end = robot.wait();
  EXPECT_EQ(end.exit_code, 130) << end.err;
  EXPECT_THAT(end.err, HasSubstr("robot: serving on domain 0, interface lo"));
}

TEST_F(Link, NobodyThereIsSaidAndCured) {
  const Outcome status = run_program({"link", "status", "--domain", "9", "--seconds", "0.5"});
  EXPECT_EQ(status.exit_code, 1);
  EXPECT_THAT(status.out, HasSubstr("domain 9, interface lo: 0 other programs"));
  EXPECT_THAT(status.err, HasSubstr("foresight robot RIG --serve"));
}

TEST_F(Link, WhatCannotBeIsRefused) {
  const auto refused = [](const std::vector<std::string>& arguments, const char* words) {
    const Outcome out = run_program(arguments);
    EXPECT_EQ(out.exit_code, 2) << arguments[1];
    EXPECT_THAT(out.err, HasSubstr(words));
  };
  refused({"link", "status", "--interface", "eth9"},
          "there is no network interface 'eth9'; set link.interface to one of");
  refused({"link", "status", "--peer", "no-such-host.invalid"}, "nobody knows the peer 'no-such-host.invalid'");
  refused({"link", "rate", "joint_states", "--domain", "77"}, "nobody writes this topic");
  refused({"robot", rig(), "--mock", "--stepped", "--serve"}, "a network's time cannot be stepped");
}

}  // namespace
}  // namespace foresight
