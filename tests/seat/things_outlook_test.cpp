// Things that stand elsewhere than the model has them, shown where images show them: pictures of the ray caster's lab.
#include "seat/things_outlook.hpp"

#include <algorithm>

#include "input/hand_of_rig.hpp"
#include "prediction/grasp/hand_path.hpp"
#include "seat/predicted_place.hpp"
#include "seat/tool_script.hpp"
#include "tests/sighting/pictured_room.hpp"
#include "tests/support/folders.hpp"

namespace foresight::things_outlook_test {
namespace {

using namespace std::chrono_literals;

class ThingsSeen : public testing::Test {
 protected:
  static const sim::PicturedRoom& room() {
    static const sim::PicturedRoom built(320);
    return built;
  }
  ThingsSeen() {
    robot_.status = StateStatus::predicted;
    robot_.time = now_;
    robot_.joints = rig_.joints.size();
    for (std::size_t i = 0; i < rig_.joints.size(); ++i)
      robot_.position[i] = sim::shafts_at_rest(rig_.joints[i].drive.name).value_or(0);
    outlook_.advance(robot_);
  }
  /// What is shown of the brick at the newest instant.
  Eigen::Vector3d shown() const {
    SceneState state{robot_.time, StateStatus::predicted, room().rest()};
    outlook_.place(state);
    return state.T_world_node[room().nodes[0]].translation();
  }
  void wait(Duration time) {
    for (const RobotTime end = robot_.time + time; robot_.time < end;) {
      robot_.time = robot_.time + 20ms;
      outlook_.advance(robot_);
    }
  }
  /// Of the tool in the arm's base, `aside` (m) along y of where the jaws close on the brick, and so far above it.
  Pose at_brick(double aside, double above) const {
    const std::vector<ToolStep> steps = pick_and_place(rig_, *scene_, "brick_red", "tray");
    const auto close = std::ranges::find_if(steps.begin() + 1, steps.end(),
                                            [](const ToolStep& s) { return s.what == ToolStep::What::gripper; });
    Pose out = rig_.T_world_robot.inverse() * (close - 1)->T_world_tool;
    out.translation() += Eigen::Vector3d(0, aside, above);
    return out;
  }
  /// The hand that is shown takes the brick, and lifts it by 0.12 m.
  void grasp_and_lift() {
    go({{"above", at_brick(0, 0.12), kOpen, 3, true},
        {"down", at_brick(0, 0), kOpen, 1.5},
        {"close", at_brick(0, 0), kClosed, 1},
        {"lift", at_brick(0, 0.12), kClosed, 1.5}});
  }
  /// It sets the brick down `aside` of where it took it, and goes up.
  void set_down(double aside) {
    go({{"across", at_brick(aside, 0.12), kClosed, 2},
        {"down", at_brick(aside, 0.002), kClosed, 1.5},
        {"open", at_brick(aside, 0.002), kOpen, 1},
        {"up", at_brick(aside, 0.12), kOpen, 1}});
  }
  void go(const std::vector<HandStop>& stops) {
    const HandOptions hand = hand_options(rig_);
    const InverseKinematics kinematics(*hand.arm);
    const JointVector from = joints_of(robot_.position, hand.arm_joints);
    const auto finger =
        static_cast<std::size_t>(std::ranges::find(hand.roles, JointRole::gripper) - hand.roles.begin());
    const HandPath path(kinematics, from, robot_.position[finger], stops);
    for (double t = 0; t < path.seconds(); t += 0.02) {
      const JointVector q = path.joints(t);
      for (std::size_t i = 0; i < hand.arm_joints.size(); ++i)
        robot_.position[hand.arm_joints[i]] = q[static_cast<Eigen::Index>(i)];
      robot_.position[finger] = path.grip(t);
      wait(20ms);
    }
  }
  /// An image of `truth`, 500 ms old when it comes.
  void see(const sim::LabState& truth) {
    SceneState thought{robot_.time - 500ms, StateStatus::exact, room().rest()};
    outlook_.place(thought);
    PosedFrame frame = room().frame(truth, thought.T_world_node, ++number_);
    frame.left.time = frame.right->time = thought.time;
    frame.left.scene.time = thought.time;
    const std::uint64_t before = outlook_.counts().looked;
    outlook_.saw(frame, [this](std::string_view name) { return positions_of(rig_, robot_.position)(name); });
    ASSERT_EQ(outlook_.counts().looked, before + 1);
  }

  static constexpr double kOpen = 0.038, kClosed = 0.016;  // m, of the jaws' joint
  const Rig rig_ = read_rig(source_folder() / "configs" / "minerva.yaml");
  const std::shared_ptr<const LiveScene> scene_ = std::make_shared<const LiveScene>(room().live(), room().lenses);
  ThingsOutlook outlook_{
      rig_, scene_, {{"brick_red", 0.09, {}}, {"brick_blue", 0.09, {}}, {"no such thing", 1, {}}}, false};
  RobotTime now_{20'000'000'000};
  PredictedRobot robot_;
  std::uint64_t number_ = 0;
};

TEST_F(ThingsSeen, AThingThatStandsElsewhereIsShownThereOnceItsImageCame) {
  wait(700ms);
  sim::LabState truth = room().rest();
  see(truth);
  Pose& brick = truth[room().nodes[0]];
  EXPECT_LT((shown() - brick.translation()).norm(), 0.004);
  brick.translation() += Eigen::Vector3d(0.009, -0.012, 0);  // somebody moves it by 15 mm
  wait(700ms);
  EXPECT_GT((shown() - brick.translation()).norm(), 0.01) << "no image has come";
  for (int i = 0; i < 3; ++i) {
    see(truth);
    wait(100ms);
  }
  wait(300ms);
  EXPECT_LT((shown() - brick.translation()).norm(), 0.004);
  SceneState then{robot_.time - 500ms, StateStatus::exact, room().rest()};
  outlook_.place(then);
  EXPECT_LT((then.T_world_node[room().nodes[0]].translation() - brick.translation()).norm(), 0.004)
      << "textures of images under way go onto it where it was";
  EXPECT_EQ(outlook_.counts().missing, 0u);
}

TEST_F(ThingsSeen, AClockThatBeginsAnewIsGoneAlongWith) {
  wait(700ms);
  sim::LabState truth = room().rest();
  truth[room().nodes[0]].translation() += Eigen::Vector3d(0.009, -0.012, 0);
  robot_.time = RobotTime{5'000'000'000};
  outlook_.advance(robot_);
  ASSERT_EQ(outlook_.future()->time(), robot_.time);
  wait(700ms);
  for (int i = 0; i < 3; ++i) {
    see(truth);
    wait(100ms);
  }
  wait(300ms);
  EXPECT_LT((shown() - truth[room().nodes[0]].translation()).norm(), 0.004) << "images count by the new clock";
}

// 2 mm are less than a pixel there: no print wanders to and fro for what an outline may be off.
TEST_F(ThingsSeen, WhatRestsStaysWhileImagesCannotTell) {
  wait(700ms);
  const Eigen::Vector3d before = shown();
  sim::LabState truth = room().rest();
  truth[room().nodes[0]].translation() += Eigen::Vector3d(0.001, -0.0015, 0);
  for (int i = 0; i < 4; ++i) {
    see(truth);
    wait(100ms);
  }
  EXPECT_GT(outlook_.counts().taken, 2u) << "it is seen all the same";
  EXPECT_LT((shown() - before).norm(), 1e-6);
}

// In reality the jaws closed on nothing: within a few images, half a second old, the seat shows the brick where it is.
TEST_F(ThingsSeen, WhatSlippedOutOfTheHandIsPutBackWhereImagesShowIt) {
  wait(700ms);
  const sim::LabState truth = room().rest();
  see(truth);
  const Eigen::Vector3d on_table = truth[room().nodes[0]].translation();
  grasp_and_lift();
  ASSERT_TRUE(outlook_.future()->thing(0).held);
  EXPECT_NEAR(shown().z() - on_table.z(), 0.12, 0.01) << "it goes with the hand at once";
  ASSERT_EQ(outlook_.lines().size(), 1u);
  EXPECT_THAT(outlook_.lines()[0], testing::MatchesRegex("brick_red: in the hand, within [0-9]+ mm"));
  wait(600ms);
  for (int i = 0; i < 4 && outlook_.future()->thing(0).held; ++i) {
    see(truth);
    wait(100ms);
  }
  EXPECT_FALSE(outlook_.future()->thing(0).held);
  wait(400ms);
  EXPECT_LT((shown() - on_table).norm(), 0.004);
  EXPECT_EQ(outlook_.counts().moved, 1u);
  EXPECT_EQ(outlook_.future()->failed_grasps(), 1u);
  EXPECT_TRUE(outlook_.lines().empty());
}

// The model takes it along and puts it down by itself: only an image of afterwards tells whether it truly lies there.
TEST_F(ThingsSeen, WhatWasPutDownIsNotSeenThereUntilAnImageShowsIt) {
  EXPECT_FALSE(outlook_.seen_at_rest("brick_red"));
  wait(700ms);
  see(room().rest());
  EXPECT_TRUE(outlook_.seen_at_rest("brick_red"));
  EXPECT_FALSE(outlook_.seen_at_rest("no such thing"));
  grasp_and_lift();
  EXPECT_FALSE(outlook_.seen_at_rest("brick_red")) << "it is in the hand";
  set_down(0.03);
  ASSERT_EQ(outlook_.future()->thing(0).status, ThingStatus::predicted);
  sim::LabState truth = room().rest();
  truth[room().nodes[0]].translation() = shown();
  wait(700ms);
  EXPECT_FALSE(outlook_.seen_at_rest("brick_red")) << "nothing has been seen of it since";
  see(truth);
  EXPECT_TRUE(outlook_.seen_at_rest("brick_red"));
  EXPECT_LT((shown() - truth[room().nodes[0]].translation()).norm(), 0.005);
}

TEST_F(ThingsSeen, WhatWasNeverMovedIsSeenWhereItStandsNotWhereTheModelPutIt) {
  wait(700ms);
  const sim::LabState truth = room().rest();
  see(truth);
  grasp_and_lift();
  set_down(0.03);
  const Eigen::Vector3d before = truth[room().nodes[0]].translation(), put = shown();
  ASSERT_GT((put - before).norm(), 0.025);
  for (int i = 0; i < 6 && !outlook_.seen_at_rest("brick_red"); ++i) {
    wait(100ms);
    see(truth);
  }
  EXPECT_TRUE(outlook_.seen_at_rest("brick_red"));
  wait(700ms);
  EXPECT_LT((shown() - before).norm(), 0.01) << "at first sight within some pixels, and nowhere near where it was put";
}

TEST_F(ThingsSeen, WhatIsGoneIsToldInWords) {
  wait(700ms);
  sim::LabState truth = room().rest();
  see(truth);
  EXPECT_TRUE(outlook_.lines().empty());
  truth[room().nodes[0]].translation().z() -= 3;
  for (int i = 0; i < 8 && outlook_.lines().empty(); ++i) {
    wait(100ms);
    see(truth);
  }
  ASSERT_FALSE(outlook_.lines().empty());
  EXPECT_THAT(outlook_.lines()[0], testing::HasSubstr("brick_red: not where it was"));
}

TEST_F(ThingsSeen, OldImagesAndImagesOfOtherCamerasDoNothing) {
  const Eigen::Vector3d before = shown();
  PosedFrame frame = room().frame(room().rest(), room().rest(), 1);
  frame.left.time = robot_.time - 100s;
  outlook_.saw(frame, [](std::string_view) { return std::nullopt; });
  EXPECT_EQ(outlook_.counts().looked, 0u);
  wait(100ms);
  frame.left.time = robot_.time;
  frame.left.pixels = frame.left.pixels(cv::Rect(0, 0, 100, 100)).clone();
  outlook_.saw(frame, [](std::string_view) { return std::nullopt; });
  EXPECT_EQ(outlook_.counts().taken, 0u);
  EXPECT_LT((shown() - before).norm(), 1e-4);
}

}  // namespace
}  // namespace foresight::things_outlook_test
