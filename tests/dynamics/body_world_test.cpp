#include "dynamics/body_world.hpp"

#include "common/error.hpp"
#include "tests/dynamics/solids.hpp"

namespace foresight::body_world_test {
namespace {

constexpr double kGravity = 9.81;

void run(BodyWorld& world, double seconds) {
  for (int i = 0; i < std::lround(seconds / world.seconds_per_step()); ++i) world.step();
}

struct Table {
  BodyWorld world{BodyWorldOptions{}};
  std::size_t top = world.add_still(box_mesh({2, 2, 0.1f}, {0, 0, -0.05f}), Pose::Identity(), {.friction = 0.9});
};

TEST(BodyWorld, FallsAsBodiesFall) {
  BodyWorld world(BodyWorldOptions{});
  const auto box = world.add_loose(box_mesh({0.1f, 0.1f, 0.1f}), lifted(0, 0, 10), 0.3, {});
  run(world, 1);
  EXPECT_NEAR(world.motion(box).T_world_body.translation().z(), 10 - kGravity / 2, 0.02);
  EXPECT_NEAR(world.motion(box).velocity.z(), -kGravity, 1e-6);
}

TEST(BodyWorld, RestsWhereItWasSetDown) {
  Table table;
  const auto box = table.world.add_loose(box_mesh({0.05f, 0.05f, 0.05f}), lifted(0.1, 0.2, 0.025), 0.1, {});
  const auto upper = table.world.add_loose(box_mesh({0.05f, 0.05f, 0.05f}), lifted(0.1, 0.21, 0.075), 0.1, {});
  run(table.world, 3);
  EXPECT_LT((table.world.motion(box).T_world_body.translation() - Eigen::Vector3d(0.1, 0.2, 0.025)).norm(), 1e-3);
  EXPECT_LT((table.world.motion(upper).T_world_body.translation() - Eigen::Vector3d(0.1, 0.21, 0.075)).norm(), 2e-3);
  const Pose before = table.world.motion(box).T_world_body;
  run(table.world, 1);
  EXPECT_TRUE(table.world.motion(box).T_world_body.matrix() == before.matrix()) << "asleep";
}

TEST(BodyWorld, SlidesAsFarAsFrictionLetsIt) {
  Table table;
  const double friction = 0.4 * 0.9, speed = 1;
  const auto box = table.world.add_loose(box_mesh({0.1f, 0.1f, 0.02f}), lifted(-0.5, 0, 0.01), 0.2, {.friction = 0.4});
  run(table.world, 0.2);
  Motion push = table.world.motion(box);
  push.velocity.x() = speed;
  table.world.put(box, push);
  run(table.world, 2);
  EXPECT_NEAR(table.world.motion(box).T_world_body.translation().x(), -0.5 + speed * speed / (2 * friction * kGravity),
              0.01);
}

TEST(BodyWorld, ABallRollsOn) {
  Table table;
  const auto ball = table.world.add_loose(ball_mesh(0.03f), lifted(-0.5, 0, 0.03), 0.05, {.friction = 0.7});
  Motion push = table.world.motion(ball);
  push.velocity.x() = 0.4;
  table.world.put(ball, push);
  run(table.world, 1.5);
  const Motion now = table.world.motion(ball);
  EXPECT_GT(now.velocity.x(), 0.2) << "two sevenths go into turning";
  EXPECT_NEAR(now.turning.y() * 0.03, now.velocity.x(), 0.02) << "without slip";
}

TEST(BodyWorld, PushesWithWhatIsDrivenAndIsNotPushedItself) {
  Table table;
  const auto box = table.world.add_loose(box_mesh({0.05f, 0.05f, 0.05f}), lifted(0.1, 0, 0.025), 0.1, {});
  const auto wall = table.world.add_driven(box_mesh({0.02f, 0.1f, 0.1f}), lifted(0, 0, 0.05), {});
  for (int i = 0; i < 500; ++i) {
    table.world.place(wall, lifted(0.2 * i / 500, 0, 0.05));
    table.world.step();
  }
  EXPECT_NEAR(table.world.motion(box).T_world_body.translation().x(), 0.2 + 0.01 + 0.025, 2e-3);
  EXPECT_NEAR(table.world.motion(wall).T_world_body.translation().x(), 0.2 * 499 / 500, 1e-12);
  EXPECT_FALSE(table.world.touches().empty());
}

TEST(BodyWorld, WhatIsHeldGoesWithTheHandAndFallsWhenItIsLetGo) {
  Table table;
  const auto box = table.world.add_loose(box_mesh({0.05f, 0.05f, 0.05f}), lifted(0, 0, 0.025), 0.1, {});
  table.world.hold(box, true);
  for (int i = 1; i <= 250; ++i) {
    table.world.place(box, lifted(0.3 * i / 250, 0, 0.025 + 0.2 * i / 250));
    table.world.step();
  }
  EXPECT_TRUE(table.world.motion(box).T_world_body.isApprox(lifted(0.3, 0, 0.225), 1e-12));
  table.world.hold(box, false);
  run(table.world, 0.1);
  EXPECT_NEAR(table.world.motion(box).velocity.x(), 0.6, 0.02) << "it flies on";
  run(table.world, 2);
  EXPECT_LT(table.world.motion(box).T_world_body.translation().z(), 0.05);
}

TEST(BodyWorld, RepeatsBitForBit) {
  const auto film = [] {
    Table table;
    std::vector<std::size_t> boxes;
    for (int i = 0; i < 6; ++i)
      boxes.push_back(table.world.add_loose(box_mesh({0.05f, 0.06f, 0.04f}),
                                            lifted(0.013 * i, 0.007 * i, 0.03 + 0.06 * i), 0.1, {.friction = 0.6}));
    run(table.world, 1.5);
    std::vector<double> out;
    for (const auto box : boxes) {
      const Pose pose = table.world.motion(box).T_world_body;
      out.insert(out.end(), pose.matrix().data(), pose.matrix().data() + 16);
    }
    return out;
  };
  EXPECT_EQ(film(), film());
}

TEST(BodyWorld, MendsWhatIsNotFinite) {
  Table table;
  const auto box = table.world.add_loose(box_mesh({0.05f, 0.05f, 0.05f}), lifted(0, 0, 0.025), 0.1, {});
  Motion bad;
  bad.T_world_body = lifted(std::nan(""), 0, 0);
  table.world.put(box, bad);
  run(table.world, 0.5);
  EXPECT_LT((table.world.motion(box).T_world_body.translation() - Eigen::Vector3d(0, 0, 0.025)).norm(), 5e-3);
}

TEST(BodyWorld, RefusesWhatIsNotPossible) {
  EXPECT_THROW(BodyWorld({.step = 0}), InputError);
  BodyWorld world(BodyWorldOptions{});
  EXPECT_THROW(world.add_loose(box_mesh({1, 1, 1}), Pose::Identity(), 0, {}), InputError);
  EXPECT_THROW(world.add_loose(box_mesh({1, 1, 1}), Pose::Identity(), std::nan(""), {}), InputError);
  EXPECT_THROW(world.add_still(box_mesh({1, 1, 1}), lifted(std::nan(""), 0, 0), {}), InputError);
  EXPECT_NO_THROW(world.add_still({}, Pose::Identity(), {})) << "a node without triangles";
}

}  // namespace
}  // namespace foresight::body_world_test
