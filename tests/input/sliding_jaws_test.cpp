// What jaws of a rig grasp with, by its robot model.
#include "input/sliding_jaws.hpp"

#include <gmock/gmock.h>

#include "rig/rig_draft.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/six_axis_arm.hpp"

namespace foresight::sliding_jaws_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kDepth = 0.028;
constexpr double kMount = 0.03 * 0.9;  // m from the tool to the palm

Rig rig_of(const std::string& urdf) {
  const TempFolder folder;
  RigDraftOptions options;
  options.urdf = folder.write("arm.urdf", urdf);
  return draft_rig(options).rig;
}
SlidingJaws jaws_of(const BoxJaws& jaws) {
  return sliding_jaws(rig_of(six_axis_urdf(0.9, jaws)), kDepth);
}
std::string refusal(const BoxJaws& jaws) {
  const Rig rig = rig_of(six_axis_urdf(0.9, jaws));
  return input_error([&] { sliding_jaws(rig, kDepth); });
}

TEST(SlidingJaws, OfTheLabsArmAreAsItsDrawingHasThem) {
  const SlidingJaws jaws = sliding_jaws(read_rig(source_folder() / "configs/minerva.yaml"), kDepth);
  const SlidingJaws::Place open = jaws.at(0.081), closed = jaws.at(0.037);
  ASSERT_EQ(open.joints.size(), 1u);
  EXPECT_NEAR(open.joints[0], 0.038, 1e-6);
  EXPECT_NEAR(closed.joints[0], 0.016, 1e-6);
  for (const SlidingJaws::Place& place : {open, closed}) {
    EXPECT_TRUE(place.T_tool_grip.linear().isIdentity(1e-6));
    EXPECT_TRUE(place.T_tool_grip.translation().isApprox(Eigen::Vector3d(0, 0, 0.15), 1e-6));
  }
  EXPECT_EQ(jaws.depth, kDepth);
  EXPECT_NEAR(jaws.widest.gap, 0.085 - 2 * 0.0004, 1e-6);
  EXPECT_NEAR(jaws.narrowest.gap, 0.005 + 2 * 0.0004, 1e-6);
}

TEST(SlidingJaws, GoNoFartherThanTheirJoints) {
  const SlidingJaws jaws = jaws_of({});
  EXPECT_NEAR(jaws.at(1).gap, 0.98 * 0.07 + 0.01 * 0.07, 1e-6);
  EXPECT_NEAR(jaws.at(1).joints[0], 0.99 * 0.035, 1e-9);
  EXPECT_NEAR(jaws.at(-1).joints[0], 0.01 * 0.035, 1e-9);
}

TEST(SlidingJaws, AreFoundHoweverTheToolsFrameIsTurned) {
  for (const auto& [rpy, way, points] :
       {std::tuple{"0 0 0", Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)},
        {"0 0 1.5707963", Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1)},
        {"0 0 0.78539816", Eigen::Vector3d(-M_SQRT1_2, M_SQRT1_2, 0), Eigen::Vector3d(0, 0, 1)},
        {"1.5707963 0 0", Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0)}}) {
    BoxJaws jaws;
    jaws.mount_rpy = rpy;
    const Pose T = jaws_of(jaws).at(0.05).T_tool_grip;
    EXPECT_NEAR(std::abs(T.linear().col(1).dot(way)), 1, 1e-6) << rpy;
    EXPECT_NEAR(T.linear().col(2).dot(points), 1, 1e-6) << rpy;
    EXPECT_NEAR(T.linear().determinant(), 1, 1e-6);
    EXPECT_TRUE(T.translation().isApprox(Eigen::Vector3d(0, 0, kMount) + 0.06 * points, 1e-6)) << rpy;
  }
}

TEST(SlidingJaws, OfTwoDrivesMeetInTheMiddle) {
  BoxJaws two;
  two.moves = BoxJaws::Moves::two_drives;
  const SlidingJaws::Place place = jaws_of(two).at(0.05);
  ASSERT_EQ(place.joints.size(), 2u);
  for (const double joint : place.joints) EXPECT_NEAR(joint, 0.025, 1e-6);
  EXPECT_NEAR(place.T_tool_grip.translation().y(), 0, 1e-6);
}

// The other stands still: the middle between them goes half of the way.
TEST(SlidingJaws, AJawAloneClosesOnWhatStandsBesideIt) {
  BoxJaws one;
  one.moves = BoxJaws::Moves::one;
  one.most = 0.07;
  const SlidingJaws jaws = jaws_of(one);
  for (const double gap : {0.03, 0.06}) {
    const SlidingJaws::Place place = jaws.at(gap);
    EXPECT_NEAR(place.joints[0], gap, 1e-6);
    EXPECT_NEAR(place.T_tool_grip.translation().y(), gap / 2, 1e-6);
    EXPECT_NEAR(place.T_tool_grip.translation().z(), kMount + 0.06, 1e-6);
  }
}

TEST(SlidingJaws, LieOnAThingAsFarAsTheyStandOutOfTheHand) {
  BoxJaws stubs;
  stubs.length = 0.02;
  EXPECT_NEAR(jaws_of(stubs).depth, 0.017, 1e-6);
}

/// Each jaw's tip is bent inwards by a box of its own, which ends `from_tips` (m) before the tips.
std::string hooked(double from_tips) {
  std::string urdf = six_axis_urdf(0.9, {});
  for (const auto& [name, side] : {std::pair{"jaw_left", 1}, {"jaw_right", -1}}) {
    const std::string link = std::string("<link name='") + name + "'>";
    const std::string hook =
        fmt::format("<visual><origin xyz='0 {} {}'/><geometry><box size='0.02 0.006 0.01'/></geometry></visual>",
                    side * -0.002, 0.055 - from_tips);
    urdf.insert(urdf.find(link) + link.size(), hook);
  }
  return urdf;
}

// By what lies on the thing, not by what is nearer to the hand.
TEST(SlidingJaws, AreAsFarApartAsWhereTheyHold) {
  EXPECT_NEAR(sliding_jaws(rig_of(hooked(0)), kDepth).at(0.04).joints[0], 0.025, 1e-6);
  EXPECT_NEAR(sliding_jaws(rig_of(hooked(0.045)), kDepth).at(0.04).joints[0], 0.02, 1e-6);
  EXPECT_NEAR(sliding_jaws(rig_of(hooked(0.045)), 0.05).at(0.04).joints[0], 0.025, 1e-6);
}

TEST(SlidingJaws, WhatIsNoSuchGripperIsRefused) {
  BoxJaws turning;
  turning.type = "revolute";
  EXPECT_THAT(refusal(turning), AllOf(HasSubstr("'grip'"), HasSubstr("turns link 'jaw_left'")));
  BoxJaws askew;
  askew.mount_rpy = "0.3 0 0";
  std::string urdf = six_axis_urdf(0.9, askew);
  const auto swap_all = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = urdf.find(from); at != std::string::npos; at = urdf.find(from, at + to.size()))
      urdf.replace(at, from.size(), to);
  };
  EXPECT_EQ(refusal(askew), "no error") << "its palm is turned alike";
  swap_all("<child link='jaw_left'/><axis xyz='0 1 0'/>", "<child link='jaw_left'/><axis xyz='1 1 1'/>");
  EXPECT_THAT(input_error([&] { sliding_jaws(rig_of(urdf), kDepth); }), HasSubstr("along several lines"));
  swap_all("<child link='jaw_right'/><axis xyz='0 -1 0'/>", "<child link='jaw_right'/><axis xyz='-1 -1 -1'/>");
  EXPECT_THAT(input_error([&] { sliding_jaws(rig_of(urdf), kDepth); }), HasSubstr("square to none of the axes"));
  urdf = six_axis_urdf(0.9, {});
  swap_all("<axis xyz='0 -1 0'/>", "<axis xyz='0 1 0'/>");
  EXPECT_THAT(input_error([&] { sliding_jaws(rig_of(urdf), kDepth); }),
              testing::AnyOf(HasSubstr("neither open nor close"), HasSubstr("nothing opposite")));
  Rig rig = rig_of(six_axis_urdf(0.9, {}));
  for (RigJoint& joint : rig.joints)
    if (joint.group == JointGroup::gripper) joint.group = JointGroup::pan_tilt;
  EXPECT_THAT(input_error([&] { sliding_jaws(rig, kDepth); }), HasSubstr("has no gripper"));
}

}  // namespace
}  // namespace foresight::sliding_jaws_test
