#include <gmock/gmock.h>

#include "motion/robot_shape.hpp"
#include "tests/robot/gate_fixture.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::clearance_test {
namespace {

/// A rod of 0.4 m upright on a plate, that turns about y; the plate's edge is something it must stay clear of.
class ClearanceTest : public testing::Test {
 protected:
  ClearanceTest() {
    const std::string text =
        "<robot name='rod'><link name='base'/><link name='rod'><visual><origin xyz='0 0 0.2'/><geometry>"
        "<box size='0.04 0.04 0.4'/></geometry></visual></link><joint name='turn' type='revolute'>"
        "<parent link='base'/><child link='rod'/><axis xyz='0 1 0'/>"
        "<limit lower='-2' upper='2' effort='1' velocity='1'/></joint>"
        "<link name='flag'><visual><geometry><box size='0.01 0.01 0.01'/></geometry></visual></link>"
        "<joint name='wave' type='revolute'><parent link='base'/><child link='flag'/><origin xyz='0 0 1'/>"
        "<axis xyz='0 0 1'/><limit lower='-2' upper='2' effort='1' velocity='1'/></joint></robot>";
    const auto file = folder_.write("rod.urdf", text);
    shape_.emplace(read_urdf(file, folder_.path()), std::vector<std::string>{"turn", "wave"}, Pose::Identity(), "rig");
    GateOptions options = two_joints();
    options.surroundings.obstacles = {{"shelf", {Eigen::Vector3d(0.3, -1, -1), Eigen::Vector3d(1, 1, 1)}}};
    gate_.emplace(options, &*shape_);
  }
  /// Where the rod begins to be too close to the shelf.
  double edge() {
    double low = 0, high = 2;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (shape_->obstructed(std::array{middle, 0.0}) ? high : low) = middle;
    }
    return low;
  }
  double margin(double position) {
    std::vector<double> all(shape_->couples());
    shape_->margins(std::array{position, 0.0}, all);
    return *std::min_element(all.begin(), all.end());
  }
  void stand_at(double position) {
    for (DriveFeedback& f : feedback_) f = {now_, 0, 0, DriveState::enabled};
    feedback_[0].position = position;
    ASSERT_TRUE(gate_->reset(feedback_, now_));
    go(position, 0, 1, false);
  }
  void go(double turn, double wave, int cycles, bool deadman = true) {
    for (int i = 0; i < cycles; ++i) {
      now_ = now_ + seconds(kDt);
      for (std::size_t k = 0; k < 2; ++k) feedback_[k] = {now_, gate_->set_point(k).position, 0, DriveState::enabled};
      MotionCommand c{7, ++sequence_, now_, deadman, 2, {turn, wave}};
      gate_->step(now_, {&c, 1}, feedback_);
      fastest_ = std::max(fastest_, std::abs(gate_->set_point(0).velocity));
      least_ = std::min(least_, margin(gate_->set_point(0).position));
    }
  }
  TempFolder folder_;
  std::optional<RobotShape> shape_;
  std::optional<SafetyGate> gate_;
  RobotTime now_{1'000'000'000};
  std::uint64_t sequence_ = 0;
  std::array<DriveFeedback, 2> feedback_;
  double fastest_ = 0, least_ = 1;
};

// As after a stop by the drives' own ramps, which knows nothing of obstacles.
TEST_F(ClearanceTest, FromInsideThereIsAWayOutAndOnlyOut) {
  double inside = edge();
  while (margin(inside) > -0.001) inside += 1e-4;
  stand_at(inside);
  const double began = margin(inside);
  ASSERT_NEAR(began, -0.001, 1e-4);
  go(inside + 0.5, 0, 200);
  EXPECT_EQ(gate_->set_point(0).position, inside) << "not farther in";
  EXPECT_EQ(gate_->status().reason, GateReason::obstructed);
  EXPECT_STREQ(gate_->status().detail, "link 'rod' comes too close to obstacle 'shelf'");
  go(inside, 0.5, 200);
  EXPECT_EQ(gate_->set_point(1).position, 0) << "what leads nowhere stays refused";
  go(0, 0, 5);
  EXPECT_EQ(gate_->status().reason, GateReason::obstructed) << "it says why it is slow";
  for (int i = 0; i < 2000 && margin(gate_->set_point(0).position) < 0; ++i) go(0, 0, 1);
  EXPECT_GE(margin(gate_->set_point(0).position), 0);
  EXPECT_LE(fastest_, 0.101) << "slowly, but for the last cycle";
  EXPECT_GE(least_, began - 1e-9) << "never closer than it stood";
  go(0, 0, 1500);
  EXPECT_EQ(gate_->status().reason, GateReason::none);
  EXPECT_NEAR(gate_->set_point(0).position, 0, 1e-3);
  EXPECT_GT(fastest_, 0.3);
}

TEST_F(ClearanceTest, SaysWhatHoldsTheRobotSinceWhenAndHowFarApartItIs) {
  stand_at(0);
  EXPECT_LT(gate_->status().hold.joint, 0);
  const double asked = edge() + 0.3;
  go(asked, 0, 1000);
  const GateHold hold = gate_->status().hold;
  EXPECT_EQ(hold.joint, 0);
  EXPECT_EQ(hold.asked, asked);
  EXPECT_EQ(hold.stands, gate_->set_point(0).position);
  EXPECT_STREQ(hold.parts, "link 'rod' comes too close to obstacle 'shelf'");
  EXPECT_NEAR(hold.apart, margin(hold.stands) + 0.02, 1e-9);
  EXPECT_GE(hold.apart, hold.kept_apart);
  EXPECT_NEAR(hold.kept_apart, 0.02, 1e-12);
  EXPECT_GT(to_seconds(now_ - hold.since), 1) << "since it was first held, and not since the last cycle";
  go(0, 0, 100);
  EXPECT_LT(gate_->status().hold.joint, 0) << "free again";
  go(asked, 0, 1000);
  go(asked, 0, 1, false);
  EXPECT_LT(gate_->status().hold.joint, 0) << "nobody asks for anything";
}

TEST_F(ClearanceTest, FromDeepInsideThereIsAWayOutToo) {
  const double inside = edge() + 0.3;
  stand_at(inside);
  go(inside + 0.2, 0, 100);
  EXPECT_EQ(gate_->set_point(0).position, inside);
  go(0, 0, 4000);
  EXPECT_NEAR(gate_->set_point(0).position, 0, 1e-3);
}

}  // namespace
}  // namespace foresight::clearance_test
