#include "dynamics/thing_world.hpp"

#include "common/error.hpp"
#include "tests/dynamics/solids.hpp"

namespace foresight::thing_world_test {
namespace {

WorldPart block(double y, double friction = 0.7, double mass = 0.1, float width = 0.045f) {
  return {box_mesh({width, width, width}), PartRole::loose, lifted(0, y, width / 2), mass, {.friction = friction}};
}

TEST(ThingWorld, JawsCloseAroundAThingAndLiftIt) {
  HandWorld hand({block(0)});
  hand.wait(0.2);
  hand.move(hand.grip, 0.01, 1);
  EXPECT_TRUE(hand.world().gripped(3));
  EXPECT_NEAR(hand.world().jaw_lag("grip"), 0.0225 - 0.01, 2.5e-3) << "they stay where it is, the shaft goes on";
  const Eigen::Vector3d before = hand.place(0);
  hand.move(hand.height, 0.23, 1);
  hand.move(hand.along, 0.3, 1);
  hand.wait(3);
  EXPECT_LT((hand.place(0) - before - Eigen::Vector3d(0.3, 0, 0.2)).norm(), 1e-3) << "it does not creep";
  hand.move(hand.grip, 0.04, 1);
  hand.wait(1);
  EXPECT_FALSE(hand.world().gripped(3));
  EXPECT_NEAR(hand.place(0).z(), 0.0225, 2e-3) << "dropped";
}

TEST(ThingWorld, AJawAlonePressesAThingAgainstTheHand) {
  HandWorld hand({block(0.004)}, {}, true);
  hand.wait(0.2);
  EXPECT_FALSE(hand.world().gripped(3));
  hand.move(hand.grip, 0.01, 1);
  EXPECT_TRUE(hand.world().gripped(3));
  hand.move(hand.height, 0.23, 1);
  EXPECT_GT(hand.place(0).z(), 0.2);
  hand.move(hand.grip, 0.04, 1);
  EXPECT_FALSE(hand.world().gripped(3));
}

TEST(ThingWorld, AThingThatIsNotInTheMiddleIsPushedThere) {
  HandWorld hand({block(0.012)});
  hand.move(hand.grip, 0.015, 1);
  EXPECT_NEAR(hand.place(0).y(), 0, 1.5e-3);
  EXPECT_TRUE(hand.world().gripped(3));
}

TEST(ThingWorld, TheSpringsForceIsBounded) {
  HandWorld hand({block(0, 0.7, 0.1)}, {.jaw_force = 20});
  hand.move(hand.grip, 0.0, 1.5);
  hand.wait(1);
  double sum = 0;
  for (const Touch& touch : hand.world().touches())
    if (touch.body == 1 || touch.other == 1) sum += touch.force;
  EXPECT_NEAR(sum, 10, 1.5) << "half of it at each jaw";
}

TEST(ThingWorld, WhatIsTooSlipperyOrTooHeavyStaysBehind) {
  for (const auto& [friction, mass] : {std::pair{0.005, 0.1}, {0.7, 20.0}}) {
    HandWorld hand({block(0, friction, mass)}, {.jaw_force = 20});
    hand.move(hand.grip, 0.01, 1);
    hand.move(hand.height, 0.23, 1);
    hand.wait(0.5);
    EXPECT_LT(hand.place(0).z(), 0.06) << friction << " " << mass;
  }
}

TEST(ThingWorld, WhatIsTooWideOrTooNarrowIsNotHeld) {
  HandWorld wide({block(0, 0.7, 0.1, 0.09f)});
  wide.height = 0.13;
  wide.wait(0.1);
  wide.move(wide.height, 0.12, 0.5);
  wide.move(wide.grip, 0.0, 1);
  EXPECT_FALSE(wide.world().gripped(3));
  HandWorld beside({block(0.3)});
  beside.move(beside.grip, 0.0, 1);
  EXPECT_FALSE(beside.world().gripped(3));
  EXPECT_NEAR(beside.world().jaw_lag("grip"), 0, 1e-9);
  EXPECT_LT((beside.place(0) - Eigen::Vector3d(0, 0.3, 0.0225)).norm(), 1e-3);
}

TEST(ThingWorld, RepeatsBitForBit) {
  const auto film = [] {
    HandWorld hand({block(0.005), block(0.2)});
    hand.move(hand.grip, 0.01, 0.8);
    hand.move(hand.height, 0.15, 0.5);
    hand.move(hand.grip, 0.04, 0.5);
    hand.wait(0.5);
    return std::pair(hand.place(0), hand.place(1));
  };
  EXPECT_EQ(film(), film());
}

TEST(ThingWorld, JointsThatAreNotNumbersMoveNothing) {
  HandWorld hand({block(0)});
  hand.grip = hand.height = std::nan("");
  hand.wait(0.1);
  EXPECT_LT((hand.place(0) - Eigen::Vector3d(0, 0, 0.0225)).norm(), 1e-3);
}

TEST(ThingWorld, RefusesAJawThatMovesNothing) {
  const PartPoses still = [](const JointPositions&) { return std::vector<Pose>(1, Pose::Identity()); };
  const std::vector<WorldPart> parts{{box_mesh({1, 1, 1}), PartRole::driven, Pose::Identity(), 0, {}}};
  const JointPositions none = [](std::string_view) { return std::nullopt; };
  EXPECT_THROW(ThingWorld(parts, still, {.jaws = {"grip"}}, none), InputError);
  EXPECT_THROW(ThingWorld(parts, still, {.jaw_force = 0}, none), InputError);
  EXPECT_NO_THROW(ThingWorld({}, still, {}, none)) << "a world without things";
}

}  // namespace
}  // namespace foresight::thing_world_test
