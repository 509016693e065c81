// Shadows of what moves, against rays to all of the lamp.
#include "texture_gpu/shadow_pass.hpp"

#include <cmath>

#include "gl/lens_rays.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/lamp_light.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::shadow_pass_test {
namespace {

class ShadowPassTest : public HeadlessTest, public testing::WithParamInterface<const char*> {
 protected:
  /// Of the camera at usual_view().
  cv::Mat light_of(const SceneLight& light, const SceneState& state) {
    const Lens lens = small_lens(GetParam());
    const auto buffers = std::make_shared<gl::SceneBuffers>(*scene_);
    const gl::FaceImages faces(gl::faces_for(lens, 2), false);
    gl::RasterPass(buffers, false)(usual_view(), state, faces);
    gl::Buffer block(sizeof(gl::CameraBlock), "camera");
    const gl::CameraBlock camera = gl::make_camera_block(lens, faces.faces);
    block.write(std::span(&camera, 1));
    ShadowMap map(buffers);
    cv::Mat out(lens.height(), lens.width(), CV_8UC4, cv::Scalar::all(255));
    if (!map.update(light, state)) return out;
    ShadowPass pass(lens);
    pass({lens, block, faces, gl::make_lens_rays(lens), usual_view()}, map);
    glGetTextureImage(pass.light().name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4),
                      out.data);
    return out;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  const Lamp lamp_{{-0.4, 0.3, 1.2}, 0.08, {3.0, 2.5, 2.0}};
};

SceneState block_above(const SceneModel& scene) {
  SceneState state = state_of(scene);
  state.T_world_node[kBlock].translation() = Eigen::Vector3d(-0.2, -0.1, 0.25);
  return state;
}

INSTANTIATE_TEST_SUITE_P(Lenses, ShadowPassTest, testing::Values("pinhole", "plumb_bob", "wide_fisheye"));

TEST_P(ShadowPassTest, ShadesWhatTheBlockHidesFromTheLamp) {
  const SceneState state = block_above(*scene_);
  const cv::Mat light = light_of({lamp_, {false, false, true, false}}, state);
  // All that throws shadows, and only what stands still.
  const reference::RayCaster all(*scene_, state);
  SceneState gone = state;
  gone.T_world_node[kBlock].translation().z() = -50;
  const reference::RayCaster still(*scene_, gone);
  const Lens lens = small_lens(GetParam());
  double sum = 0, shaded = 0;
  int count = 0, far_off = 0;
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      const auto ray = lens.unproject({x, y});
      if (!ray) continue;
      const Eigen::Vector3d direction = usual_view().linear() * *ray;
      const auto hit = all.cast(usual_view().translation(), direction, 0.01);
      if (!hit || hit->node == kBlock || hit->edge < 0.02) continue;
      Eigen::Vector3d n = normal_of(*scene_, state, hit->triangle);
      if (n.dot(direction) > 0) n = -n;
      const double before = lamp_light(lamp_, still, hit->p_world, n, 64).x();
      // Where what stands still hides a part of the lamp, the pass only tells all or nothing.
      const double open = lamp_light({lamp_.position, 0, lamp_.strength}, still, hit->p_world, n, 1).x();
      if (std::abs(before - open) > 0.05) continue;
      const double expected = std::pow(lamp_light(lamp_, all, hit->p_world, n, 64).x() / before, 1 / kResponse);
      const double error = light.at<cv::Vec4b>(y, x)[0] / 255.0 - expected;
      sum += std::abs(error);
      shaded += 1 - expected;
      far_off += std::abs(error) > 0.15;
      ++count;
    }
  ASSERT_GT(count, 1000);
  EXPECT_LT(sum, 0.12 * shaded) << sum << " of " << shaded << " at " << count;
  EXPECT_LT(far_off, count / 200) << far_off << " of " << count;
}

TEST_P(ShadowPassTest, LeavesAllAsItIsWhereNothingMovesOrTheLampStandsAmongIt) {
  const SceneState state = block_above(*scene_);
  const Lamp within{state.T_world_node[kBlock].translation(), 0.05, {1, 1, 1}};
  for (const SceneLight& light :
       {SceneLight{lamp_, {false, false, false, false}}, SceneLight{within, {false, false, true, false}}}) {
    const cv::Mat factors = light_of(light, state);
    EXPECT_EQ(cv::countNonZero(factors.reshape(1) != 255), 0);
  }
}

}  // namespace
}  // namespace foresight::shadow_pass_test
