#include "sim/physics/physical_lab.hpp"

#include "common/error.hpp"
#include "sim/lab_task.hpp"
#include "tests/physics/lab_hand.hpp"

namespace foresight::sim::physical_lab_test {
namespace {

using namespace std::chrono_literals;

constexpr double kOpen = 0.038, kClosed = 0.014, kAbove = 0.16;
constexpr RobotTime kStart{5'000'000'000};

std::shared_ptr<const LiveLab> lab() {
  static const auto world =
      std::make_shared<const LiveLab>(LiveLab::Options{.texel = 0.02, .task = 0u, .loose = lab_thing_names()});
  return world;
}

PhysicsOptions exact() {
  PhysicsOptions out;
  out.hidden = {1, 0, 0, 0, 0};
  return out;
}

Eigen::Vector3d place(PhysicalLab& world, const std::string& thing, RobotTime time) {
  return world.thing_at(thing, time).translation();
}

/// Grasps the red brick and carries it over the tray, where it is let go.
std::shared_ptr<const HandPath> pick() {
  static const auto path = [] {
    const Part& brick = lab()->lab().parts[static_cast<std::size_t>(lab()->lab().find("brick_red"))];
    const Part& tray = lab()->lab().parts[static_cast<std::size_t>(lab()->lab().find("tray"))];
    const double yaw = 8 * std::numbers::pi / 180;
    const Eigen::Vector3d at = brick.T_world_part.translation() + Eigen::Vector3d(0, 0, 0.03);
    const Eigen::Vector3d up(0, 0, kAbove), over = tray.T_world_part.translation() + Eigen::Vector3d(0, 0, 0.05);
    const HandStop stops[] = {
        {"above", reaching_down(at + up, yaw), kOpen, 3, true}, {"down", reaching_down(at, yaw), kOpen, 2},
        {"close", reaching_down(at, yaw), kClosed, 1.5},        {"lift", reaching_down(at + up, yaw), kClosed, 1.5},
        {"over", reaching_down(over + up, yaw), kClosed, 2},    {"lower", reaching_down(over, yaw), kClosed, 1.5},
        {"open", reaching_down(over, yaw), kOpen, 1},           {"leave", reaching_down(over + up, yaw), kOpen, 1.5}};
    return std::make_shared<const HandPath>(lab_kinematics(), bent_arm(), kOpen, stops);
  }();
  return path;
}

TEST(PhysicalLab, EverythingRestsWhereTheModelHasIt) {
  PhysicalLab world(
      lab(), [](std::string_view joint, RobotTime) { return shafts_at_rest(joint); }, kStart, exact());
  const LabState state = world.state_at(kStart + 1s);
  ASSERT_EQ(state.size(), lab()->lab().parts.size());
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (lab()->is_loose(i)) {
      EXPECT_LT((state[i].translation() - lab()->modelled_rest()[i].translation()).norm(), 3e-3)
          << lab()->lab().parts[i].name;
    }
  }
}

TEST(PhysicalLab, EverythingFallsAsleep) {
  PhysicalLab world(
      lab(), [](std::string_view joint, RobotTime) { return shafts_at_rest(joint); }, kStart, exact());
  const LabState before = world.state_at(kStart + 4s), after = world.state_at(kStart + 5s);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_TRUE(before[i].matrix() == after[i].matrix()) << lab()->lab().parts[i].name << " is still awake";
}

TEST(PhysicalLab, TheShaftsGraspABrickCarryItAndDropItIntoTheTray) {
  const auto path = pick();
  PhysicalLab world(lab(), shafts_on(path, kStart), kStart, exact());
  const auto when = [&](std::size_t stop) { return kStart + seconds(path->reached(stop)); };
  const Eigen::Vector3d before = place(world, "brick_red", when(1));
  EXPECT_LT(
      (before - lab()->modelled_rest()[static_cast<std::size_t>(lab()->lab().find("brick_red"))].translation()).norm(),
      2e-3);
  EXPECT_NEAR(world.jaw_lag("finger"), 0, 1e-6);
  place(world, "brick_red", when(2));
  EXPECT_TRUE(world.gripped("brick_red"));
  EXPECT_GT(world.jaw_lag("finger"), 0.004) << "the jaws stay where the brick is";
  EXPECT_NEAR(place(world, "brick_red", when(3)).z() - before.z(), kAbove, 2e-3);
  EXPECT_TRUE(world.gripped("brick_red"));
  const Eigen::Vector3d lifted = place(world, "brick_red", when(4));
  const Pose tray = world.thing_at("tray", when(4));
  EXPECT_LT((lifted - tray.translation()).head<2>().norm(), 5e-3);
  place(world, "brick_red", when(7) + 1s);
  EXPECT_FALSE(world.gripped("brick_red"));
  const Eigen::Vector3d end = place(world, "brick_red", when(7) + 1s);
  EXPECT_LT((end - tray.translation()).head<2>().norm(), 0.03);
  EXPECT_NEAR(end.z(), kTrayBoard, 3e-3) << "on the tray's floor";
  EXPECT_LT((place(world, "tray", when(7) + 1s) - tray.translation()).norm(), 3e-3);
}

TEST(PhysicalLab, WhoAsksAndWhenMakesNoDifference) {
  const auto path = pick();
  PhysicalLab often(lab(), shafts_on(path, kStart), kStart), seldom(lab(), shafts_on(path, kStart), kStart);
  const RobotTime end = kStart + seconds(path->reached(3)) + 1234567ns;
  for (RobotTime t = kStart; t < end; t = t + 7ms) often.state_at(t);
  for (RobotTime t = kStart; t < end; t = t + 2900ms) seldom.state_at(t);
  const LabState a = often.state_at(end), b = seldom.state_at(end);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(a[i].matrix() == b[i].matrix()) << lab()->lab().parts[i].name;
  const LabState earlier = often.state_at(end - 500ms), again = seldom.state_at(end - 500ms);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(earlier[i].matrix() == again[i].matrix());
}

TEST(PhysicalLab, TruthDiffersFromTheModelByTheSeed) {
  const ShaftsAt rest = [](std::string_view joint, RobotTime) { return shafts_at_rest(joint); };
  PhysicsOptions options;
  options.hidden = {3, 0.2, 0.2, 0.004, 0.05};
  PhysicalLab one(lab(), rest, kStart, options), same(lab(), rest, kStart, options);
  options.hidden.seed = 4;
  PhysicalLab other(lab(), rest, kStart, options);
  const auto brick = static_cast<std::size_t>(lab()->lab().find("brick_red"));
  const Pose modelled = lab()->modelled_rest()[brick], there = one.thing_at("brick_red", kStart);
  EXPECT_TRUE(there.matrix() == same.thing_at("brick_red", kStart).matrix());
  EXPECT_FALSE(there.isApprox(other.thing_at("brick_red", kStart), 1e-6));
  EXPECT_FALSE(there.isApprox(modelled, 1e-6));
  EXPECT_LT((there.translation() - modelled.translation()).norm(), 0.0065);
}

TEST(PhysicalLab, AHandThatSweepsOverTheTablePushesTheBall) {
  const auto ball = static_cast<std::size_t>(lab()->lab().find(kBall));
  const Eigen::Vector3d at = lab()->modelled_rest()[ball].translation();
  const HandStop stops[] = {{"beside", reaching_down(at + Eigen::Vector3d(0.02, -0.12, 0.0), 0), 0.01, 3, true},
                            {"push", reaching_down(at + Eigen::Vector3d(0.02, 0.02, 0.0), 0), 0.01, 1}};
  const auto path = std::make_shared<const HandPath>(lab_kinematics(), bent_arm(), 0.01, stops);
  PhysicalLab world(lab(), shafts_on(path, kStart), kStart, exact());
  EXPECT_LT((place(world, kBall, kStart + 3s) - at).norm(), 2e-3);
  EXPECT_GT(place(world, kBall, kStart + 4s).y(), at.y() + 0.06);
}

TEST(PhysicalLab, RefusesWhatIsNotPossible) {
  const ShaftsAt rest = [](std::string_view joint, RobotTime) { return shafts_at_rest(joint); };
  PhysicsOptions options;
  options.hidden.mass = 2;
  EXPECT_THROW(PhysicalLab(lab(), rest, kStart, options), InputError);
  options.hidden = {1, 0.1, std::nan(""), 0, 0};
  EXPECT_THROW(PhysicalLab(lab(), rest, kStart, options), InputError);
  options = {};
  options.jaws = {"claw"};
  EXPECT_THROW(PhysicalLab(lab(), rest, kStart, options), InputError);
  const auto fixed = std::make_shared<const LiveLab>(LiveLab::Options{.texel = 0.02});
  EXPECT_THROW(PhysicalLab(fixed, rest, kStart), InputError) << "its things are not loose";
  PhysicalLab world(lab(), rest, kStart);
  EXPECT_THROW(world.thing_at("unicorn", kStart), std::out_of_range);
}

}  // namespace
}  // namespace foresight::sim::physical_lab_test
