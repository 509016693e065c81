// Models of real things are bumpy: what stands a little above a surface may be none, and does not take its colours
// away.
#include "display/predicted_view.hpp"
#include "pictures/view_alpha.hpp"
#include "scene/primitives.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::bumpy_model_test {
namespace {

enum BumpyNode { kFloor, kBump, kThing };
constexpr double kAccuracy = 0.02;                           // m
constexpr double kBumpHeight = 0.004, kThingHeight = 0.008;  // less and more than a quarter of it

/// A floor, and two slabs on it beside each other.
std::shared_ptr<const SceneModel> bumpy_scene() {
  const auto lying = [](const char* name, double x, double y, double side, double height) {
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(x, y, height / 2);
    return Node{name, make_box({side, side, height}), -1, pose};
  };
  Node floor = lying("floor", 0, 0, 1.5, 0.02);
  floor.T_parent_node.translation().z() = -0.01;
  return std::make_shared<SceneModel>(std::vector<Node>{floor, lying("bump", 0, 0.09, 0.12, kBumpHeight),
                                                        lying("thing", 0, -0.09, 0.12, kThingHeight)});
}

Lens lens(double f, int width, int height) {
  Lens::Parameters p;
  p.width = width, p.height = height;
  p.fx = p.fy = f, p.cx = (width - 1) / 2.0, p.cy = (height - 1) / 2.0;
  return Lens(p);
}

/// What hides a point of the floor, and all within 2 mm, from `eye`; nothing where that is not one slab. Pixels that
/// show its edge are farther away than that.
std::optional<std::size_t> what_hides(const Eigen::Vector3d& p, const Eigen::Vector3d& eye,
                                      const reference::RayCaster& caster) {
  std::optional<int> slab;
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d way = p + 0.002 * Eigen::Vector3d(i % 3 - 1, i / 3 - 1, 0) - eye;
    const auto hit = caster.cast(eye, way, 0.01);
    if (!hit || hit->node == kFloor || hit->node != slab.value_or(hit->node)) return std::nullopt;
    slab = hit->node;
  }
  return static_cast<std::size_t>(*slab);
}

using BumpyModelTest = HeadlessTest;

// Both hide the floor behind them by less depth than the model may err: only what stands upright on the floor tells.
TEST_F(BumpyModelTest, WhatABumpHidesIsShownUncertainAndWhatAThingHidesIsFilled) {
  const auto scene = bumpy_scene();
  const SceneState state = state_of(*scene);
  const Lens narrow = lens(1000, 560, 240), wide = lens(640, 480, 360);
  const auto surface = std::make_shared<SurfacePatches>(find_surface_patches(*scene, {}));
  const TextureOptions options{.memory_bytes = 6 << 20, .depth_tolerance = kAccuracy, .even_exposure = false};
  TextureCore core(scene, surface, narrow, std::nullopt, options, driver_.is_software);
  LatestTextures textures;
  LatestImages images;
  const Pose aside = look_at({-0.5, 0, 0.3}, {0.03, 0, 0}), opposite = look_at({0.3, 0, 0.35}, {0.06, 0, 0});
  const PosedImage image = posed_photograph(*scene, state, narrow, aside);
  core.process({image, std::nullopt}, textures);
  ASSERT_TRUE(core.look({image, std::nullopt}, images));

  PredictedView view(std::make_shared<gl::SceneBuffers>(*scene), std::make_shared<SurfaceRecords>(*surface), wide);
  view.mix_silhouettes(false);
  view.draw(opposite, state, *textures.acquire(), *images.acquire());
  cv::Mat stored(wide.height(), wide.width(), CV_8UC4);
  glGetTextureImage(view.picture().name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(stored.total() * 4),
                    stored.data);

  const reference::RayCaster caster(*scene, state);
  struct Count {
    int hidden = 0, uncertain = 0, certain = 0, of_the_slab = 0;
  };
  std::array<Count, 3> behind;
  for (int y = 0; y < stored.rows; ++y)
    for (int x = 0; x < stored.cols; ++x) {
      const auto floor = caster.cast(opposite.translation(), opposite.linear() * *wide.unproject({x, y}), 0.01);
      if (!floor || floor->node != kFloor) continue;
      const auto slab = what_hides(floor->p_world, aside.translation(), caster);
      if (!slab) continue;
      const cv::Vec4b& pixel = stored.at<cv::Vec4b>(y, x);
      Count& count = behind[*slab];
      ++count.hidden;
      count.uncertain += pixel[3] == view_alpha::kFromEdge;
      count.certain += pixel[3] == 255;
      const Eigen::Vector3d hue = 255 * paint(static_cast<int>(*slab), {0, 0, 0});
      count.of_the_slab += (Eigen::Vector3d(pixel[0], pixel[1], pixel[2]) - hue).norm() < 60;
    }
  const Count &bump = behind[kBump], &thing = behind[kThing];
  EXPECT_GT(bump.hidden, 200);
  EXPECT_GT(bump.uncertain, 0.9 * bump.hidden);
  EXPECT_GT(bump.of_the_slab, 0.9 * bump.hidden) << "the image shows it there";
  EXPECT_GT(thing.hidden, 600);
  EXPECT_EQ(thing.uncertain, 0) << "it would be shown twice, where it stands and on what it hides";
  EXPECT_EQ(bump.certain + thing.certain, 0) << "nobody has seen the floor there";
}

}  // namespace
}  // namespace foresight::bumpy_model_test
