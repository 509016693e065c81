// Who commands, in words for people beside the robot.
#include "link/control/lease_news.hpp"

#include "tests/control/small_line.hpp"

namespace foresight::lease_news_test {
namespace {

using namespace std::chrono_literals;

class LeaseNewsTest : public SmallLineTest {
 protected:
  std::string news() { return news_.of(desk_, now_); }
  LeaseNews news_;
};

TEST_F(LeaseNewsTest, TellsOnceWhoCommandsAndWhoAsks) {
  EXPECT_EQ(news(), "");
  seats_.push_back(&ben_);
  engage(anna_);
  EXPECT_EQ(news(), "'anna' commands");
  EXPECT_EQ(news(), "");
  EXPECT_EQ(news_.line(), "'anna' commands");
  ben_.seat.want_control(true);
  run(500ms);
  EXPECT_EQ(news(), "'ben' asks for control");
  EXPECT_EQ(news(), "");
  EXPECT_EQ(news_.line(), "'anna' commands; 'ben' asks for control: g gives it");
}

TEST_F(LeaseNewsTest, TellsWhenControlGoesToSomebodyElseOrToNobody) {
  seats_.push_back(&ben_);
  engage(anna_);
  ben_.seat.want_control(true);
  run(500ms);
  news();
  ASSERT_TRUE(desk_.consent_to_asking(now_));
  EXPECT_EQ(news(), "'ben' commands, no longer 'anna'");
  EXPECT_EQ(news_.line(), "'ben' commands");
  seats_.clear();  // both programs are gone
  run(4s);
  EXPECT_EQ(news(), "nobody commands, no longer 'ben'");
  EXPECT_EQ(news_.line(), "");
}

TEST_F(LeaseNewsTest, LeavesAStopToTheRobotsStateForWhichTheDeskKnowsWhoAskedForIt) {
  seats_.push_back(&ben_);
  engage(anna_);
  run(500ms);
  news();
  ben_.seat.request(LineRequest::emergency_stop, time_of(ben_));
  run(500ms);
  EXPECT_EQ(news(), "");
  EXPECT_EQ(desk_.stopper(), "ben") << "though anna commands";
}

}  // namespace
}  // namespace foresight::lease_news_test
