// To where work begins: all joints at once, while switch and button are held, as far as nothing is in the way.
#include <cmath>

#include "tests/input/hand_control_fixture.hpp"

namespace foresight::start_position_test {
namespace {

using Eigen::Vector3d;

// Enter, held with the switch.
class ToStart : public HandControlTest {
 protected:
  ToStart() { device_.buttons.set(TrackerButton::to_start); }
  double left(std::size_t joint) const {
    return std::abs(*world_.start(joint) - world_.hand().last().positions[joint]);
  }
  TrackerState device_ = device_at(at_, true);
};

TEST_F(ToStart, AllJointsButTheGripperArriveTogether) {
  engage();
  const JointValues before = world_.hand().last().positions;
  const double yaw = left(0), elbow = left(3);
  ASSERT_GT(yaw * elbow, 0);
  world_.cycles(60, device_);
  EXPECT_EQ(world_.hand().last().phase, HandPhase::driving);
  EXPECT_NEAR(left(0) / yaw, left(3) / elbow, 1e-3) << "on the straight way of all joints";
  world_.cycles(1500, device_);
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_EQ(world_.hand().last().positions[i], i == 7 ? before[7] : *world_.start(i)) << i;
  EXPECT_NEAR(world_.shaft(3), *world_.start(3), 1e-3);
}

TEST_F(ToStart, StopsWhenEitherIsLetGoOf) {
  world_.cycles(60, device_at(at_, false));
  TrackerState alone = device_at(at_, false);
  alone.buttons.set(TrackerButton::to_start);
  const double stands = world_.shaft(3);
  world_.cycles(200, alone);
  EXPECT_EQ(world_.shaft(3), stands) << "without the switch";
  engage();
  world_.cycles(60, device_);
  const JointValues then = world_.hand().last().positions;
  stay(100);
  EXPECT_EQ(world_.hand().last().positions, then) << "and the hand begins anew where the tool has come to";
  const Vector3d before = tool();
  go(at_ + Vector3d(0.02, 0, 0), 100);
  stay(100);
  EXPECT_NEAR((tool() - before - Vector3d(0.02, 0, 0)).norm(), 0, 1e-3);
}

TEST_F(ToStart, GoesOnlyWhereItsGuardLetsIt) {
  class Wall final : public HandGuard {
   public:
    FollowStep step(const JointValues& from, const Pose&, double) noexcept override { return stands(from); }
    FollowStep go(const JointValues& from, const JointValues&) noexcept override { return stands(from); }

   private:
    static FollowStep stands(const JointValues& from) noexcept {
      FollowStep out;
      out.q = JointVector::Map(from.data(), 7);
      out.reason = FollowReason::contact;
      return out;
    }
  } wall;
  engage();
  const JointValues before = world_.hand().last().positions;
  world_.hand().set_guard(&wall);
  world_.cycles(200, device_);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(world_.hand().last().positions[i], before[i]) << i;
  EXPECT_EQ(world_.hand().last().follow, FollowReason::contact);
  world_.hand().set_guard(nullptr);
}

TEST_F(ToStart, AHeadThatSomebodyWearsStaysWithHim) {
  engage();
  world_.others[8] = 0.3;
  world_.cycles(1500, device_);
  EXPECT_EQ(world_.hand().last().positions[8], 0.3);
  EXPECT_EQ(world_.hand().last().positions[3], *world_.start(3));
}

}  // namespace
}  // namespace foresight::start_position_test
