// `foresight input` as a user runs it.
#include <gmock/gmock.h>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::input_test {
namespace {

using testing::HasSubstr;

class Input : public testing::Test {
 protected:
  std::string recording() const {
    std::string text = "time_s,x,y,z,qx,qy,qz,qw,gripper\n";
    for (int i = 0; i <= 100; ++i) text += std::to_string(0.02 * i) + ",0.1,0,0,0,0,0,1,65\n";
    return folder_.write("tip.csv", text).string();
  }
  TempFolder folder_;
};

TEST_F(Input, DevicesAreListed) {
  // A socket that nobody answers at, wherever this runs.
  const Outcome list = run_program({"input", "list"}, {.environment = {{"SPNAV_SOCKET", folder_ / "none"}}});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  EXPECT_THAT(list.out, HasSubstr("keyboard"));
  EXPECT_THAT(list.out, HasSubstr("spacemouse"));
}

TEST_F(Input, ARecordingIsShownAndRecordedAgain) {
  const std::string again = (folder_ / "again.csv").string();
  const Outcome first = run_program({"input", "show", recording(), "--record", again});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("forward    100.0"));
  EXPECT_THAT(first.out, HasSubstr("switch  clutch  grip 0.50"));
  const Outcome second = run_program({"input", "show", again});
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_THAT(second.out, HasSubstr("switch  clutch  grip 0.50"));
  EXPECT_EQ(run_program({"input", "show", recording(), "--record", again}).exit_code, 2) << "it stays";
}

TEST_F(Input, WhatIsNotThereIsSaid) {
  const Outcome mouse = run_program({"input", "show", "spacemouse", "--seconds", "0.1"},
                                    {.environment = {{"SPNAV_SOCKET", folder_ / "none"}}});
  EXPECT_EQ(mouse.exit_code, 1);
  EXPECT_THAT(mouse.out, HasSubstr("systemctl start spacenavd"));
  for (const char* wrong : {"keyboard", "gamepad:x", "gamepad:99", "/nowhere/trace.csv"}) {
    const Outcome outcome = run_program({"input", "show", wrong});
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_THAT(outcome.last_line(), HasSubstr("foresight: ")) << wrong;
  }
}

}  // namespace
}  // namespace foresight::input_test
