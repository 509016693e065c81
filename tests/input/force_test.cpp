// What a device that can push is told.
#include "input/force.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace foresight::force_test {
namespace {

using namespace std::chrono_literals;

class ForceTest : public testing::Test {
 protected:
  HandContact cycle(bool engaged = true) {
    now_ = now_ + 10ms;
    force_.cycle(now_, engaged);
    return device_.rows().back().contact;
  }
  OperatorTime now_{1'000'000'000};
  RecordedForce device_{1000};
  BoundedForce force_{device_};
};

TEST_F(ForceTest, AContactGrowsToItsDepthWithoutAKick) {
  force_.cycle(now_, true);
  double before = 0, depth = 0;
  for (int i = 0; i < 20; ++i) {
    force_.feel(now_, {{0, 0, 3}, 0.01, 2});
    depth = cycle().depth;
    EXPECT_LE(depth - before, 0.2 * 0.01 + 1e-12);
    before = depth;
  }
  EXPECT_DOUBLE_EQ(depth, 0.01);
  EXPECT_DOUBLE_EQ(device_.rows().back().contact.out_in_space.z(), 1) << "a direction";
  EXPECT_DOUBLE_EQ(device_.rows().back().contact.damping, 2);
}

TEST_F(ForceTest, NothingIsBeyondItsLimits) {
  force_.cycle(now_, true);
  for (int i = 0; i < 100; ++i) {
    force_.feel(now_, {{-1, 0, 0}, 5, 1e9});
    const HandContact told = cycle();
    EXPECT_LE(told.depth, 0.02);
    EXPECT_LE(told.damping, 10);
  }
  force_.feel(now_, {{NAN, 0, 0}, 0.01, 1});
  EXPECT_EQ(cycle().depth, 0);
  force_.feel(now_, {{1, 0, 0}, NAN, NAN});
  EXPECT_EQ(cycle().depth, 0);
  EXPECT_EQ(device_.rows().back().contact.damping, 0);
  force_.feel(now_, {{1, 0, 0}, -1, -1});
  EXPECT_EQ(cycle().damping, 0) << "a negative damping would drive the hand";
}

TEST_F(ForceTest, WithoutNewsOrAnEngagedHandItLetsGo) {
  const auto pressed = [&] {
    for (int i = 0; i < 20; ++i) {
      force_.feel(now_, {{1, 0, 0}, 0.01, 1});
      cycle();
    }
    return device_.rows().back().contact.depth;
  };
  ASSERT_GT(pressed(), 0.005);
  EXPECT_EQ(cycle(false).depth, 0);
  ASSERT_GT(pressed(), 0.005);
  for (int i = 0; i < 11; ++i) cycle();
  EXPECT_EQ(device_.rows().back().contact.depth, 0) << "contacts are no longer computed";
}

TEST_F(ForceTest, TheRecordingKeepsTheNewest) {
  RecordedForce few(3);
  for (int i = 0; i < 5; ++i) few.push({i}, {});
  ASSERT_EQ(few.rows().size(), 3u);
  EXPECT_EQ(few.rows().front().time.ns, 2);
  EXPECT_EQ(few.rows().back().time.ns, 4);
}

}  // namespace
}  // namespace foresight::force_test
