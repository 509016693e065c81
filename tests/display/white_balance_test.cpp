// A camera whose white balance changes, and what views show.
#include "display/predicted_view.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::white_balance_view_test {
namespace {

class WhiteBalanceView : public HeadlessTest {
 protected:
  static constexpr int kImages = 12;
  static Pose camera(int i) { return look_at({-0.9 + 0.05 * i, -0.8, 0.75}, {0.02 * i - 0.2, 0.05, 0.1}); }
  SceneState state(int i) const {
    SceneState out = state_of(*scene_);
    out.time = RobotTime{} + seconds(0.4 * i);
    return out;
  }
  /// Seen from where image i is taken, with the white balance of image `balance`: redder and less blue, step by step.
  PosedImage image(int i, int balance) const {
    PosedImage out = posed_photograph(*scene_, state(i), lens_, camera(i), 0.7);
    const double red = 1 + 0.04 * balance;
    cv::multiply(out.pixels, cv::Scalar(1 / red, 1, red), out.pixels);
    return out;
  }
  /// Mean of shown - true of each channel, grey levels, BGR: seen again from where the first image was taken, the
  /// newest one's white balance is to be shown.
  cv::Vec3d difference(int images_looked_up, bool even_exposure) {
    LatestTextures textures;
    LatestImages images;
    TextureCore core(
        scene_, surface_, lens_, std::nullopt,
        {.memory_bytes = 64 << 20, .images = images_looked_up, .even_exposure = even_exposure, .shadows = false},
        driver_.is_software);
    for (int i = 0; i < kImages; ++i) {
      const PosedFrame frame{image(i, i), std::nullopt};
      if (images_looked_up == 0) {
        core.process(frame, textures);
        continue;
      }
      core.look(frame, images);
      core.extract(textures);
    }
    PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
    view.draw(camera(0), state(0), textures.acquire(), images.acquire());
    const cv::Mat shown = view.read();
    const PosedImage truth = image(0, kImages - 1);
    cv::Vec3d sum;
    int count = 0;
    for (int y = 0; y < shown.rows; ++y)
      for (int x = 0; x < shown.cols; ++x) {
        const auto& pixel = shown.at<cv::Vec4b>(y, x);
        if (pixel[3] != 255) continue;
        ++count;
        for (int c = 0; c < 3; ++c) sum[c] += pixel[c] - truth.pixels.at<cv::Vec3b>(y, x)[c];
      }
    EXPECT_GT(count, 2000);
    return sum / std::max(count, 1);
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  const Lens lens_ = small_lens("plumb_bob");
};

TEST_F(WhiteBalanceView, WhatWasSeenBeforeIsShownInTheNewestImagesBalance) {
  for (const int images : {0, 1, 4}) {
    SCOPED_TRACE(std::to_string(images) + " images looked up");
    const cv::Vec3d evened = difference(images, true);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(evened[c], 0, 1) << "channel " << c;
  }
  const cv::Vec3d as_it_came = difference(0, false);
  EXPECT_GT(as_it_came[0], 2);
  EXPECT_LT(as_it_came[2], -2);
}

}  // namespace
}  // namespace foresight::white_balance_view_test
