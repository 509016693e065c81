// Scripts move a tool as a hand would: within what joints may, to where they were told.
#include "seat/tool_script.hpp"
#include "common/error.hpp"
#include "tests/support/folders.hpp"

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
    ToolScript script(rig, tour(rig, seed, 6), {});
    JointValues at{};
    script.begin_at(at);
    constexpr double kStep = 0.02;
    int steps = 0;
    for (; steps < 10000; ++steps) {
      const auto next = script.step(kStep, {});
      if (!next) break;
      for (std::size_t i = 0; i < rig.joints.size(); ++i) {
        const DriveConfig& drive = rig.joints[i].drive;
        EXPECT_LE(std::abs((*next)[i] - at[i]), drive.max_velocity * kStep * 1.001) << drive.name << " step " << steps;
        EXPECT_GE((*next)[i], drive.min_position - 1e-9);
        EXPECT_LE((*next)[i], drive.max_position + 1e-9);
      }
      at = *next;
    }
    EXPECT_GT(steps, 500) << "seed " << seed;
    EXPECT_LT(steps, 10000) << "it never ended";
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

TEST(ToolScript, AnUnreachablePoseIsRefused) {
  const Rig rig = minerva();
  ToolStep far{ToolStep::What::line};
  far.T_world_tool.translation() = Eigen::Vector3d(5, 5, 5);
  EXPECT_THROW(ToolScript(rig, {far}, {}), InputError);
}

}  // namespace
}  // namespace foresight::tool_script_test
