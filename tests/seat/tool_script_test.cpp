// Scripts move a tool as a hand would: within what joints may, to where they were told.
#include "common/error.hpp"
#include "rig/open_stereo.hpp"
#include "rig/rig_draft.hpp"
#include "rig/rig_scene.hpp"
#include "seat/tour.hpp"
#include "sim/lab_task.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/six_axis_arm.hpp"

namespace foresight::tool_script_test {
namespace {

Rig minerva() {
  return read_rig(source_folder() / "configs" / "minerva.yaml");
}

TEST(ToolScript, ATourKeepsWithinJointsAndAwayFromObstacles) {
  const Rig rig = minerva();
  const auto shape = rig.shape();
  shape->surround(rig.surroundings);
  for (const unsigned seed : {1u, 2u, 3u}) {
    ToolScript script(rig, tour(rig, seed, 25), {});
    JointValues at{};
    script.begin_at(at);
    constexpr double kStep = 0.02;
    int steps = 0;
    bool was_clear = false;
    for (; steps < 20000; ++steps) {
      const auto next = script.step(kStep, {});
      if (!next) break;
      for (std::size_t i = 0; i < rig.joints.size(); ++i) {
        const DriveConfig& drive = rig.joints[i].drive;
        EXPECT_LE(std::abs((*next)[i] - at[i]), drive.max_velocity * kStep * 1.001) << drive.name << " step " << steps;
        EXPECT_GE((*next)[i], drive.min_position - 1e-9);
        EXPECT_LE((*next)[i], drive.max_position + 1e-9);
      }
      at = *next;
      const char* const in_the_way = shape->obstructed({at.data(), rig.joints.size()});
      ASSERT_FALSE(was_clear && in_the_way != nullptr) << "seed " << seed << ", step " << steps << ": " << in_the_way;
      was_clear = in_the_way == nullptr;
    }
    EXPECT_TRUE(was_clear);
    EXPECT_GT(steps, 500) << "seed " << seed;
    EXPECT_LT(steps, 20000) << "it never ended";
  }
}

TEST(ToolScript, TheSameSeedGivesTheSameTour) {
  const Rig rig = minerva();
  const auto one = tour(rig, 5, 4), same = tour(rig, 5, 4), other = tour(rig, 6, 4);
  ASSERT_EQ(one.size(), 4u);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(one[i].T_world_tool.isApprox(same[i].T_world_tool, 0));
  EXPECT_FALSE(one[0].T_world_tool.isApprox(other[0].T_world_tool));
}

TEST(ToolScript, GoesOnFromWhereALossLeftIt) {
  const Rig rig = minerva();
  ToolScript script(rig, tour(rig, 1, 3), {});
  script.begin_at({});
  JointValues at{};
  for (int i = 0; i < 60; ++i) at = script.step(0.02, {}).value();
  JointValues elsewhere = at;
  elsewhere[1] += 0.05;
  script.begin_at(elsewhere);
  const JointValues next = script.step(0.02, {}).value();
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(next[i], elsewhere[i], 0.03) << i;
}

/// All the way, as the gate sees it. At home the arm may be too close to something.
void expect_clear(const Rig& rig, const std::vector<ToolStep>& steps) {
  const auto shape = rig.shape();
  shape->surround(rig.surroundings);
  ToolScript script(rig, steps, {});
  script.begin_at(home_of(rig));
  bool was_clear = false;
  while (const auto next = script.step(0.02, {})) {
    const char* const in_the_way = shape->obstructed({next->data(), rig.joints.size()});
    ASSERT_FALSE(was_clear && in_the_way != nullptr) << in_the_way;
    was_clear = in_the_way == nullptr;
  }
  EXPECT_TRUE(was_clear);
}

void expect_picked_clear(const Rig& rig, unsigned layout, const char* brick) {
  SCOPED_TRACE(fmt::format("layout {}, {}", layout, brick));
  const LiveScene scene = live_scene_of(rig, true, std::nullopt, true, layout);
  expect_clear(rig, pick_and_place(rig, scene, brick, "tray"));
}

// A hand turned across the forearm meets it where the wrist is bent most; a brick can be taken from four sides.
TEST(ToolScript, PicksSoThatTheArmStaysClear) {
  const Rig rig = minerva();
  for (unsigned layout = 0; layout <= 20; ++layout)
    for (const char* const brick : {"brick_red", "brick_blue"}) expect_picked_clear(rig, layout, brick);
}

// With the joints that are nearest to home, the hand meets the forearm from each side.
TEST(ToolScript, PicksByWhateverJointsAreClear) {
  Rig rig = minerva();
  rig.T_world_robot =
      Eigen::Translation3d(0, -0.35, 1.7) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d(1, 1, 0).normalized());
  rig.surroundings.workspace.extend(Eigen::Vector3d(0, 0, 2.5));
  for (RigJoint& joint : rig.joints) {
    if (joint.drive.name == "shoulder_pitch") joint.drive.offset = 0.8;
    if (joint.drive.name == "elbow") joint.drive.offset = 1.4;
  }
  expect_picked_clear(rig, 1, "brick_blue");
  expect_picked_clear(rig, 2, "brick_red");
}

/// The rig that `foresight rig new` makes of an arm of its own, before the lab's table.
Rig six_axes(const BoxJaws& jaws, double size = 0.9) {
  const TempFolder folder;
  RigDraftOptions options;
  options.urdf = folder.write("arm.urdf", six_axis_urdf(size, jaws));
  Rig rig = read_rig(folder.write("rig.yaml", rig_text(draft_rig(options), options, folder / "rig.yaml")));
  rig.T_world_robot = Eigen::Translation3d(0, -0.5, 0) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  return rig;
}

/// Does the brick of the physical lab end in the tray?
bool picks(const Rig& rig) {
  using namespace std::chrono_literals;
  const LiveScene scene = live_scene_of(rig, true, std::nullopt, true, 0);
  ToolScript script(rig, pick_and_place(rig, scene, "brick_red", "tray"), {.pan = 0, .tilt = 0});
  MockWorld world = mock_world(rig);
  sim::PhysicsOptions& options = world.physics.emplace();
  options.hidden = {1, 0, 0, 0, 0};  // nobody looks where the brick is
  options.jaws.clear();
  for (const RigJoint& joint : rig.joints)
    if (joint.group == JointGroup::gripper) options.jaws.push_back(joint.drive.name);
  constexpr Duration kStep = 20ms;
  std::vector<JointValues> path{home_of(rig)};
  script.begin_at(path.front());
  while (const auto next = script.step(to_seconds(kStep), {})) path.push_back(*next);
  const std::vector<std::string> names = rig.joint_names();
  const RobotTime start = RobotTime{} + 10s;
  const sim::ShaftsAt shafts = [&](std::string_view joint, RobotTime time) -> std::optional<double> {
    const auto found = std::ranges::find(names, joint);
    if (found == names.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(found - names.begin());
    const double steps = std::clamp(to_seconds(time - start) / to_seconds(kStep), 0.0, path.size() - 1.0);
    const auto before = static_cast<std::size_t>(steps);
    return std::lerp(path[before][i], path[std::min(before + 1, path.size() - 1)][i], steps - std::floor(steps));
  };
  sim::PhysicalLab lab(mock_lab(world), shafts, start, options);
  for (std::size_t i = 0; i < path.size() + 50; ++i) lab.thing_at("brick_red", start + static_cast<int>(i) * kStep);
  const RobotTime end = start + static_cast<int>(path.size() + 50) * kStep;
  return sim::lies_in_tray(lab.thing_at("brick_red", end), lab.thing_at("tray", end));
}

TEST(ToolScript, PicksWithJawsOfAnyKind) {
  BoxJaws turned, large, two, one;
  turned.mount_rpy = "0 0 1.5707963";
  large.most = 0.06;
  large.length = 0.11;
  large.thickness = 0.02;
  two.moves = BoxJaws::Moves::two_drives;
  one.moves = BoxJaws::Moves::one;
  one.most = 0.07;
  for (const BoxJaws& jaws : {BoxJaws{}, turned, large, two, one})
    EXPECT_TRUE(picks(six_axes(jaws))) << six_axis_urdf(0.9, jaws);
}

TEST(ToolScript, JawsThatDoNotTakeABrickAreRefused) {
  const auto refusal = [](const BoxJaws& jaws) {
    const Rig rig = six_axes(jaws);
    const LiveScene scene = live_scene_of(rig, true, std::nullopt, true, 0);
    return input_error([&] { pick_and_place(rig, scene, "brick_red", "tray"); });
  };
  BoxJaws narrow, open, stubs;
  narrow.most = 0.02;
  open.gap = 0.045;
  stubs.length = 0.01;
  using testing::HasSubstr;
  EXPECT_THAT(refusal(narrow), HasSubstr("the jaws open 0.040 m, a brick is 0.045 m wide, and 0.006 m more"));
  EXPECT_THAT(refusal(open), HasSubstr("the jaws close to 0.046 m, a brick is 0.045 m wide"));
  EXPECT_THAT(refusal(stubs), HasSubstr("the jaws stand 0.007 m out of the hand"));
}

/// Where the tool is when the jaws close, if the brick is seen by `seen` from where the model has it.
Pose closes_at(const Pose& T_there_seen, const std::string& node) {
  const Rig rig = minerva();
  const LiveScene scene = live_scene_of(rig, true, std::nullopt, true, 0);
  const std::vector<ToolStep> steps = pick_and_place(rig, scene, "brick_red", "tray");
  ToolScript script(rig, steps, {});
  script.look_by([&](const std::string& name) -> std::optional<Pose> {
    if (name != node) return std::nullopt;
    return place_at_rest(scene, name) * T_there_seen;
  });
  const HandOptions hand = hand_options(rig);
  const std::size_t jaw = 7;
  JointValues at{}, last{};
  script.begin_at(at);
  bool opened = false;
  while (const auto next = script.step(0.02, {})) {
    last = std::exchange(at, *next);
    opened = opened || at[jaw] > 0.03;
    if (opened && at[jaw] < last[jaw]) break;
  }
  return rig.T_world_robot * hand.arm->tip_pose(joints_of(at, hand.arm_joints));
}

TEST(ToolScript, TakesAThingWhereItIsSeen) {
  Pose moved = Pose::Identity();
  moved.translation() = Eigen::Vector3d(0.03, -0.02, 0.01);
  moved.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  const Pose planned = closes_at(Pose::Identity(), "brick_red"), taken = closes_at(moved, "brick_red");
  const LiveScene scene = live_scene_of(minerva(), true, std::nullopt, true, 0);
  const Eigen::Vector3d shift = place_at_rest(scene, "brick_red").linear() * moved.translation();
  EXPECT_NEAR((taken.translation() - planned.translation() - Eigen::Vector3d(shift.x(), shift.y(), 0)).norm(), 0, 2e-3)
      << "along the ground";
  const Eigen::AngleAxisd turned(taken.linear() * planned.linear().transpose());
  EXPECT_NEAR(turned.angle() * turned.axis().z(), 0.3, 2e-2);
  // What is not about it does not follow it.
  EXPECT_TRUE(closes_at(moved, "brick_blue").isApprox(planned, 1e-6));
}

TEST(ToolScript, WhatIsSeenOutOfReachIsLookedForWhereItWasPlanned) {
  Pose far = Pose::Identity();
  far.translation().x() = 5;
  EXPECT_TRUE(closes_at(far, "brick_red").isApprox(closes_at(Pose::Identity(), "brick_red"), 1e-6));
}

// A link that turns about the vertical over a floor: nearer than a tour's room, and never nearer than at home.
TEST(ToolScript, WhatCannotComeNearerDoesNotHinderATour) {
  Rig rig = six_axes({});
  rig.surroundings = {};
  const std::vector<double> home(rig.joints.size(), 0);
  double lowest = 1;
  for (const GuardedLink& link : rig.shape()->guarded(home))
    if (link.name == "turret") lowest = std::min(link.body.a.z(), link.body.b.z()) - link.body.radius;
  const double top = lowest - rig.surroundings.clearance - 0.004;
  rig.surroundings.obstacles = {{"floor", {Eigen::Vector3d(-2, -2, top - 0.1), Eigen::Vector3d(2, 2, top)}}};
  const auto steps = tour(rig, 1, 8);
  ASSERT_EQ(steps.size(), 8u);
  // All else has room.
  const auto shape = rig.shape();
  Surroundings wide = rig.surroundings;
  wide.clearance += 0.009;
  shape->surround(wide);
  std::vector<double> margins(shape->couples());
  ToolScript script(rig, steps, {.pan = 0, .tilt = 0});
  script.begin_at(home_of(rig));
  bool was_clear = false;
  while (const auto next = script.step(0.05, {})) {
    shape->margins({next->data(), rig.joints.size()}, margins);
    bool is_clear = true;
    for (std::size_t i = 0; i < margins.size(); ++i)
      if (margins[i] < 0 && std::string_view(shape->message(i)) != "link 'turret' comes too close to obstacle 'floor'")
        is_clear = false;
    EXPECT_FALSE(was_clear && !is_clear);
    was_clear = is_clear;
  }
  EXPECT_TRUE(was_clear);
}

bool points_down(const ToolStep& step) {
  return (step.T_world_tool.linear() * -Eigen::Vector3d::UnitZ()).z() > 0.99;
}

// Wherever it stands, its jaws are hardly farther from its wrist than the clearance.
TEST(ToolScript, AnArmThatIsNearItselfIsToured) {
  Rig rig = six_axes({}, 0.2);
  rig.T_world_robot = Pose::Identity();
  const auto steps = tour(rig, 1, 8);
  ASSERT_EQ(steps.size(), 8u);
  for (const ToolStep& step : steps) EXPECT_TRUE(points_down(step));
  expect_clear(rig, steps);
}

// The benches' figures are of these.
TEST(ToolScript, ATourOfTheLabsArmIsOverItsTable) {
  const Rig rig = minerva();
  double low = 1, high = 0;
  for (const ToolStep& step : tour(rig, 1, 200)) {
    low = std::min(low, step.T_world_tool.translation().z());
    high = std::max(high, step.T_world_tool.translation().z());
  }
  EXPECT_GE(low, 0.30 - 1e-12);
  EXPECT_LE(high, 0.55 + 1e-12);
  EXPECT_NEAR(low, 0.30, 0.02);
  EXPECT_GT(high, 0.45) << "higher ones are out of reach";
}

/// The lab's arm, `scale` times as large, on the ground or hanging from above, with nothing about it.
Rig scaled(double scale, bool hangs = false) {
  Rig rig = minerva();
  for (UrdfJoint& joint : rig.robot->joints) joint.T_parent_joint.translation() *= scale;
  for (Node& link : rig.robot->links) {
    link.T_parent_node.translation() *= scale;
    for (auto& vertex : link.mesh.vertices) vertex *= static_cast<float>(scale);
  }
  for (Mesh& mesh : rig.robot->collision)
    for (auto& vertex : mesh.vertices) vertex *= static_cast<float>(scale);
  rig.T_world_robot = Pose::Identity();
  if (hangs) rig.T_world_robot = Eigen::Translation3d(0, 0, 3) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
  rig.surroundings = {};
  rig.surroundings.clearance = 1e-3;  // a small one's fingers are near its own forearm
  return rig;
}

TEST(ToolScript, ATourIsAsLargeAsTheArm) {
  for (const double scale : {0.4, 2.2}) {
    const Rig rig = scaled(scale);
    const auto steps = tour(rig, 1, 20);
    ASSERT_EQ(steps.size(), 20u) << scale;
    for (const ToolStep& step : steps) {
      EXPECT_GT(step.T_world_tool.translation().z(), 1.05 * scale - 1e-9);
      EXPECT_LT(step.T_world_tool.translation().z(), 1.30 * scale + 1e-9);
      EXPECT_LT(step.T_world_tool.translation().head<2>().norm(), 0.75 * 0.89 * scale + 1e-9);
    }
    ToolScript(rig, steps, {});
  }
  Rig hanging = scaled(1, true);
  for (Node& link : hanging.robot->links) link.mesh = {};  // how it bends there is another matter
  hanging.robot->collision.clear();
  const auto below = tour(hanging, 1, 20);
  ASSERT_FALSE(below.empty());
  for (const ToolStep& step : below) EXPECT_LT(step.T_world_tool.translation().z(), 3 - 1.05 + 1e-9);
}

// Turned over in its URDF rather than by robot.pose.
TEST(ToolScript, AnArmThatHangsByItsUrdfIsToured) {
  Rig rig = scaled(1, true);
  const Pose turned = std::exchange(rig.T_world_robot, Pose::Identity());
  for (UrdfJoint& joint : rig.robot->joints) {
    Node& child = rig.robot->links[static_cast<std::size_t>(joint.child)];
    if (child.parent != 0) continue;
    joint.T_parent_joint = turned * joint.T_parent_joint;
    child.T_parent_node = turned * child.T_parent_node;
  }
  const auto steps = tour(rig, 1, 20);
  ASSERT_EQ(steps.size(), 20u);
  for (const ToolStep& step : steps) {
    EXPECT_LT(step.T_world_tool.translation().z(), 3 - 0.95 - 0.3 * 0.89);
    EXPECT_TRUE(points_down(step));
  }
}

// As that of a SCARA or of a gantry: its tool has the heights that it has.
TEST(StartPosition, IsWhatTheRigSaysOrClearAllTheWayFromHome) {
  Rig lab = minerva();
  give_start(lab);
  EXPECT_EQ(lab.joints[3].start, minerva().joints[3].start) << "the rig's own";
  for (RigJoint& joint : lab.joints) joint.start.reset();
  give_start(lab);
  const auto shape = lab.shape();
  shape->surround(lab.surroundings);
  JointValues at{}, goal{};
  for (std::size_t i = 0; i < lab.joints.size(); ++i) {
    ASSERT_EQ(lab.joints[i].start.has_value(), lab.joints[i].group == JointGroup::arm) << i;
    goal[i] = lab.joints[i].start.value_or(0);
  }
  bool was_clear = false;
  for (int part = 0; part <= 100; ++part) {
    for (std::size_t i = 0; i < lab.joints.size(); ++i) at[i] = 0.01 * part * goal[i];
    const char* const in_the_way = shape->obstructed({at.data(), lab.joints.size()});
    ASSERT_FALSE(was_clear && in_the_way) << part << " %: " << in_the_way;
    was_clear = in_the_way == nullptr;
  }
  EXPECT_TRUE(was_clear);

  Rig without = minerva();
  without.robot.reset();
  for (RigJoint& joint : without.joints) joint.start.reset();
  give_start(without);
  EXPECT_FALSE(without.joints[3].start);
}

TEST(ToolScript, AnArmThatCannotPointDownIsTouredByItsJoints) {
  Rig rig = scaled(1);
  for (RigJoint& joint : rig.joints)
    if (joint.group == JointGroup::arm && joint.drive.name != "shoulder_yaw" && joint.drive.name != "shoulder_pitch")
      joint.drive.min_position = -5e-4, joint.drive.max_position = 5e-4;
  const auto steps = tour(rig, 1, 8);
  ASSERT_EQ(steps.size(), 8u);
  for (const ToolStep& step : steps) ASSERT_TRUE(step.joints);
  expect_clear(rig, steps);
}

TEST(ToolScript, ATourOfNoPoseIsRefused) {
  Rig rig = minerva();
  rig.T_world_robot.translation().z() += 5;
  EXPECT_THAT(input_error([&] { tour(rig, 1, 4); }),
              testing::AllOf(testing::ContainsRegex("reaches [1-9][0-9]* of 2000 of the tour's poses, 5.30 to 5.55 m"),
                             testing::HasSubstr("tool down, but there ")))
      << "which is beyond the workspace";
  Rig stiff = minerva();
  for (RigJoint& joint : stiff.joints)
    if (joint.group == JointGroup::arm) joint.drive.min_position = joint.drive.max_position - 0.01;
  EXPECT_THAT(input_error([&] { tour(stiff, 1, 4); }),
              testing::HasSubstr("reaches none of the tour's poses, 0.30 to 0.55 m above the world's origin"));
  for (RigJoint& joint : rig.joints)
    if (joint.group == JointGroup::arm) joint.group = JointGroup::pan_tilt;
  EXPECT_THAT(input_error([&] { tour(rig, 1, 4); }), testing::HasSubstr("no joint has `group: arm`"));
}

TEST(ToolScript, AnUnreachablePoseIsRefused) {
  const Rig rig = minerva();
  ToolStep far{ToolStep::What::line};
  far.T_world_tool.translation() = Eigen::Vector3d(5, 5, 5);
  EXPECT_THROW(ToolScript(rig, {far}, {}), InputError);
}

}  // namespace
}  // namespace foresight::tool_script_test
