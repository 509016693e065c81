#include "display/head/session_steps.hpp"

#include <random>

namespace foresight::session_steps_test {
namespace {

using head::SessionState;
using head::SessionStep;

TEST(SessionSteps, FollowsTheUsualLife) {
  head::SessionSteps steps;
  EXPECT_FALSE(steps.running());
  EXPECT_EQ(steps.take(SessionState::idle), SessionStep::none);
  EXPECT_EQ(steps.take(SessionState::ready), SessionStep::begin);
  EXPECT_TRUE(steps.running());
  EXPECT_FALSE(steps.visible());
  EXPECT_EQ(steps.take(SessionState::synchronized), SessionStep::none);
  EXPECT_EQ(steps.take(SessionState::visible), SessionStep::none);
  EXPECT_TRUE(steps.visible());
  EXPECT_FALSE(steps.focused());
  EXPECT_EQ(steps.take(SessionState::focused), SessionStep::none);
  EXPECT_TRUE(steps.visible() && steps.focused());
  EXPECT_EQ(steps.take(SessionState::stopping), SessionStep::end);
  EXPECT_FALSE(steps.running() || steps.visible() || steps.focused());
  EXPECT_EQ(steps.take(SessionState::idle), SessionStep::none);
  EXPECT_EQ(steps.take(SessionState::ready), SessionStep::begin) << "the headset was put on again";
  EXPECT_EQ(steps.take(SessionState::loss_pending), SessionStep::leave);
  EXPECT_FALSE(steps.running());
}

TEST(SessionSteps, LeavesForGoodWhereTheOperatorClosedIt) {
  head::SessionSteps steps;
  steps.take(SessionState::ready);
  steps.take(SessionState::stopping);
  steps.take(SessionState::idle);
  EXPECT_EQ(steps.take(SessionState::exiting), SessionStep::quit);
}

// Whatever a runtime says, and in whatever order.
TEST(SessionSteps, NeverBeginsOrEndsTwice) {
  std::mt19937 random(1);
  std::uniform_int_distribution state(0, head::kSessionStates - 1);
  head::SessionSteps steps;
  bool begun = false;
  for (int i = 0; i < 100'000; ++i) {
    const SessionStep step = steps.take(static_cast<SessionState>(state(random)));
    ASSERT_FALSE(step == SessionStep::begin && begun) << i;
    ASSERT_FALSE(step == SessionStep::end && !begun) << i;
    if (step == SessionStep::begin) begun = true;
    if (step != SessionStep::begin && step != SessionStep::none) begun = false;
    ASSERT_EQ(steps.running(), begun) << i;
  }
}

TEST(SessionSteps, HasANameForEveryState) {
  for (int i = 0; i < head::kSessionStates; ++i) EXPECT_STRNE(to_string(static_cast<SessionState>(i)), "");
}

}  // namespace
}  // namespace foresight::session_steps_test
