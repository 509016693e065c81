// The key that ends the seat lies beside those that drive.
#include "seat/seat_ending.hpp"

#include <gtest/gtest.h>

namespace foresight::seat_ending_test {
namespace {

TEST(SeatEnding, NothingThatDrivesIsEndedByAKey) {
  SeatEnding ending;
  SeatStatus status;
  status.held = status.engaged = status.control.follows = true;
  ending.see(status, HandPhase::driving);
  EXPECT_TRUE(ending.lines().empty()) << "nobody asked";
  EXPECT_FALSE(ending.press(status, HandPhase::driving));
  ASSERT_EQ(ending.lines().size(), 1u);
  EXPECT_EQ(ending.lines()[0].cure, "let go of the switch to end");

  status.held = status.engaged = false;  // a switch that does not count is held all the same
  EXPECT_FALSE(ending.press(status, HandPhase::refused));
  EXPECT_EQ(ending.lines()[0].cure, "let go of the switch to end");

  ending.see(status, HandPhase::released);
  ASSERT_EQ(ending.lines().size(), 1u) << "the robot does not know yet";
  EXPECT_FALSE(ending.press(status, HandPhase::released));

  status.control.follows = false;
  ending.see(status, HandPhase::released);
  EXPECT_TRUE(ending.lines().empty());
  EXPECT_TRUE(ending.press(status, HandPhase::released));
}

}  // namespace
}  // namespace foresight::seat_ending_test
