// What a log of a seat has, and what not.
#include "seat/seat_log.hpp"

namespace foresight::seat_log_test {
namespace {

using Lines = std::vector<SeatLine>;

TEST(SeatLog, TellsWhatChangesOnce) {
  SeatLog log;
  EXPECT_EQ(log.news(Lines{{"robot", "ready", "press"}}).size(), 1u);
  EXPECT_TRUE(log.news(Lines{{"robot", "ready", "press"}}).empty());
  const auto stopped = log.news(Lines{{"robot", "stopped", "reset (X)", Urgency::trouble}});
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_EQ(stopped[0], "robot: ! stopped -> reset (X)");
}

TEST(SeatLog, FiguresAreNoNews) {
  SeatLog log;
  EXPECT_TRUE(log.news(Lines{{"line", "commands act after 510 ms", ""}}).empty());
  EXPECT_EQ(log.news(Lines{{"images", "NO IMAGE for 1.1 s", "", Urgency::trouble}}).size(), 1u);
  EXPECT_TRUE(log.news(Lines{{"images", "NO IMAGE for 1.2 s", "", Urgency::trouble}}).empty());
}

TEST(SeatLog, TellsOfSeveralThingsThatDifferOnceEach) {
  SeatLog log;
  const Lines both{{"differs", "another calibration", "copy it", Urgency::note},
                   {"differs", "another scene", "start both alike", Urgency::note}};
  EXPECT_EQ(log.news(both).size(), 2u);
  EXPECT_TRUE(log.news(both).empty());
  EXPECT_THAT(log.news({both.data(), 1}), testing::ElementsAre("differs: no longer: another scene"));
}

TEST(SeatLog, SaysThatTroubleIsOver) {
  SeatLog log;
  log.news(Lines{{"images", "NO IMAGE for 1.1 s", "", Urgency::trouble}, {"hand", "gone", "", Urgency::note}});
  const auto over = log.news(Lines{{"images", "10 pairs", ""}});
  ASSERT_EQ(over.size(), 2u);
  EXPECT_EQ(over[0], "images:   10 pairs");
  EXPECT_EQ(over[1], "hand: no longer: gone");
  EXPECT_TRUE(log.news(Lines{{"images", "11 pairs", ""}}).empty());
}

TEST(SeatLog, TellsWhatIsHeldAndThatItWasLetGoOf) {
  SeatLog log;
  const Lines robot{{"robot", "ready", "press"}};
  log.news(robot);
  EXPECT_THAT(log.news(Lines{robot[0], {"carries", "brick_red", ""}}), testing::ElementsAre("carries:   brick_red"));
  EXPECT_TRUE(log.news(Lines{robot[0], {"carries", "brick_red", ""}}).empty());
  EXPECT_THAT(log.news(robot), testing::ElementsAre("carries: no longer: brick_red"));
  EXPECT_TRUE(log.news(robot).empty());
}

}  // namespace
}  // namespace foresight::seat_log_test
