// The key that ends the seat lies beside those that drive.
#include "seat/seat_ending.hpp"

#include <gtest/gtest.h>

namespace foresight::seat_ending_test {
namespace {

TEST(SeatEnding, AHeldSwitchIsNotLetGoOfByAKey) {
  SeatEnding ending;
  SeatStatus status;
  status.held = status.engaged = true;
  ending.see(status);
  EXPECT_TRUE(ending.lines().empty()) << "nobody asked";
  EXPECT_FALSE(ending.press(status));
  ASSERT_EQ(ending.lines().size(), 1u);
  EXPECT_EQ(ending.lines()[0].cure, "let go of the switch to end");
  status.engaged = false;
  ending.see(status);
  EXPECT_EQ(ending.lines().size(), 1u) << "a switch that does not count is held all the same";

  status.held = false;
  ending.see(status);
  EXPECT_TRUE(ending.lines().empty());
  EXPECT_TRUE(ending.press(status));
}

}  // namespace
}  // namespace foresight::seat_ending_test
