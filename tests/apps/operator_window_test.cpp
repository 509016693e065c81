// A session at the window: connect, consent, drive, lose the robot, recover.
#include "tests/apps/operator_window.hpp"

namespace foresight::operator_window_test {
namespace {

TEST_F(OperatorWindow, ConnectsDrivesLosesTheRobotAndRecovers) {
  ASSERT_TRUE(says("in command:   you"));
  ASSERT_TRUE(screen_->input("search --sync --name Foresight windowfocus"));
  // Before joints are homed: the newest image, why, and nothing in red.
  ASSERT_TRUE(tells("images", "joints tell no position"));
  EXPECT_TRUE(shows("as prediction cannot be trusted", false));
  ASSERT_TRUE(gets_ready());  // consent: enabling, homing
  EXPECT_TRUE(shows("as it will be", false));
  for (const auto& [key, words] :
       {std::pair{"F3", "from beside"}, {"F2", "left eye | right eye"}, {"Tab", "as it will be"}}) {
    ASSERT_TRUE(press(key));
    EXPECT_TRUE(shows(words, false));
  }
  const cv::Mat still = look();

  // Without the switch a key moves nothing; with it the camera turns, and what is shown with it at once.
  ASSERT_TRUE(hold("Left", true));
  ASSERT_TRUE(drives());
  ASSERT_TRUE(comes_true([&] { return changed(still, look()) > 0.02 || !drives(); }));
  ASSERT_TRUE(hold("Left", false));

  // Nothing comes any more under the held switch: the newest image, in red.
  ASSERT_TRUE(drives());
  robot_->interrupt(SIGSTOP);
  EXPECT_TRUE(shows("as prediction cannot be trusted", true));

  // The robot's program stood still, so its drives stopped by themselves. What is said to be done helps, and the switch
  // counts only once it was let go of.
  robot_->interrupt(SIGCONT);
  ASSERT_TRUE(says("robot: ! stopped"));
  ASSERT_TRUE(gets_ready());
  ASSERT_TRUE(drives());
  EXPECT_TRUE(shows("as it will be", false));
  ASSERT_TRUE(hold("shift", false));

  // Windows of all sizes.
  ASSERT_TRUE(screen_->input("search --name Foresight windowsize 1 1"));
  ASSERT_TRUE(screen_->input("search --name Foresight windowsize 500 420"));
  ASSERT_TRUE(comes_true([&] { return look().cols == 500; }));

  ASSERT_TRUE(press("q"));
  const Outcome end = seat_->wait();
  EXPECT_EQ(end.exit_code, 0) << end.err;
}

}  // namespace
}  // namespace foresight::operator_window_test
