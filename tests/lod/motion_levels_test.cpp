#include "scene/lod/motion_levels.hpp"

#include <gtest/gtest.h>

#include "sim/workshop.hpp"

namespace foresight::motion_levels_test {
namespace {

TEST(MotionLevels, HoldsWhatNobodySeesMoveAndNothingElse) {
  const SceneModel scene = sim::make_workshop({.triangles = 20'000});
  const auto cart = static_cast<std::size_t>(*scene.find("cart_3"));
  MotionView ahead;  // 10 m before it, looking at it
  ahead.T_world_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const SceneState first = sim::workshop_state(scene, 0);
  ahead.T_world_camera.translation() = first.T_world_node[cart].translation() - Eigen::Vector3d(10, 0, 0);
  MotionView beside = ahead;  // turned away by 60 degrees
  beside.T_world_camera.rotate(Eigen::AngleAxisd(1.05, Eigen::Vector3d::UnitY()));

  const auto moved = [&](double m) {
    SceneState out = first;
    out.T_world_node[cart].translation().y() += m;
    return out;
  };
  const auto follows = [&](double m, const MotionView& view) {
    MotionLevels levels(NodeBoxes(scene), {.px = 0.5});
    levels.shown(first, view);
    const SceneState shown = levels.shown(moved(m), view);
    return shown.T_world_node[cart].translation() == moved(m).T_world_node[cart].translation();
  };
  EXPECT_FALSE(follows(0.005, ahead)) << "a quarter of a pixel";
  EXPECT_TRUE(follows(0.02, ahead)) << "a pixel";
  EXPECT_FALSE(follows(0.02, beside));
  EXPECT_TRUE(follows(1, beside));
  MotionLevels everywhere(NodeBoxes(scene), {.eye_looks_ahead = false});
  everywhere.shown(first, beside);
  EXPECT_EQ(everywhere.shown(moved(0.02), beside).T_world_node[cart].translation(),
            moved(0.02).T_world_node[cart].translation());
}

TEST(MotionLevels, NeverFallsBehindByMoreThanIsAllowed) {
  const SceneModel scene = sim::make_workshop({.triangles = 20'000});
  MotionLevels levels{NodeBoxes(scene)};
  MotionView view;
  view.T_world_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.T_world_camera.translation() = Eigen::Vector3d(-11, 0, 1.6);
  const NodeBoxes boxes(scene);
  for (int i = 0; i < 200; ++i) {
    const SceneState truth = sim::workshop_state(scene, 0.02 * i), shown = levels.shown(truth, view);
    for (std::size_t n = 0; n < truth.T_world_node.size(); ++n) {
      const Pose T_camera_world = view.T_world_camera.inverse();
      const Eigen::Vector3d middle = boxes.box[n].center();
      const Eigen::Vector3d now = T_camera_world * truth.T_world_node[n] * middle,
                            then = T_camera_world * shown.T_world_node[n] * middle;
      const double ecc = std::atan2(now.head<2>().norm(), now.z());
      EXPECT_LE((now - then).norm() / now.norm(), 1.001 * 0.5 / (500 * acuity({.eccentricity = ecc})))
          << scene.nodes()[n].name;
    }
  }
  EXPECT_GT(levels.counts().moved, 1000u);
  EXPECT_LT(levels.counts().shown, levels.counts().moved) << "some are held";
  EXPECT_GT(levels.counts().shown, levels.counts().moved / 50);
}

TEST(MotionLevels, HandsBackWhatItCannotJudge) {
  const SceneModel scene = sim::make_workshop({.triangles = 20'000});
  MotionLevels levels{NodeBoxes(scene)};
  SceneState other;
  EXPECT_TRUE(levels.shown(other, {}).T_world_node.empty());
  MotionView lost;
  lost.T_world_camera.translation().x() = std::numeric_limits<double>::quiet_NaN();
  const SceneState now = sim::workshop_state(scene, 3);
  EXPECT_EQ(levels.shown(now, lost).T_world_node[5].matrix(), now.T_world_node[5].matrix());
}

}  // namespace
}  // namespace foresight::motion_levels_test
