// Images as means over time: less noise, and nothing that is out of date.
#include <opencv2/imgproc.hpp>

#include "gl/read_texture.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::accumulation_test {
namespace {

class AccumulationTest : public HeadlessTest {
 protected:
  static constexpr int kImages = 8;
  static constexpr double kNoise = 4;  // grey levels

  static Pose camera(int i) { return look_at({-1.0, -0.2 + 0.02 * i, 0.8}, {0.02, 0, 0.1}); }
  SceneState state(int i, double block_x) const {
    SceneState out = state_of(*scene_, block_x);
    out.time = RobotTime{} + seconds(0.1 * i);
    return out;
  }
  PosedImage clean(int i, double block_x = 0) const {
    return posed_photograph(*scene_, state(i, block_x), lens_, camera(i));
  }
  PosedImage noisy(int i, double block_x = 0) {
    PosedImage out = clean(i, block_x);
    cv::Mat noise(out.pixels.size(), CV_16SC3), sum;
    random_.fill(noise, cv::RNG::NORMAL, 0, kNoise);
    cv::add(out.pixels, noise, sum, cv::noArray(), CV_8UC3);
    out.pixels = sum;
    return out;
  }
  /// As views find the newest of the images: BGR.
  cv::Mat lent_after(const std::vector<PosedImage>& images) {
    TextureCore core(scene_, surface_, lens_, {},
                     {.memory_bytes = 64 << 20, .even_exposure = false, .shadows = false, .accumulate = true},
                     driver_.is_software);
    LatestTextures textures;
    LatestImages lent;
    for (const PosedImage& image : images) {
      core.look({image, std::nullopt}, lent);
      core.extract(textures);
    }
    cv::Mat out;
    cv::cvtColor(gl::read_texture(lent.acquire()->newest->camera->image()), out, cv::COLOR_RGBA2BGR);
    return out;
  }
  /// What image `i` shows of the block, but for its rim: CV_8UC1.
  cv::Mat block_in(int i, double block_x) const {
    cv::Mat difference, out;
    cv::absdiff(clean(i, block_x).pixels, clean(i, 50).pixels, difference);
    cv::cvtColor(difference, out, cv::COLOR_BGR2GRAY);
    cv::erode(out, out, {}, {-1, -1}, 2);
    return out > 0;
  }
  static double rms(const cv::Mat& a, const cv::Mat& b, const cv::Mat& only) {
    return cv::norm(a, b, cv::NORM_L2, only) / std::sqrt(3.0 * cv::countNonZero(only));
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  const Lens lens_ = small_lens("plumb_bob");
  cv::RNG random_{7};
};

TEST_F(AccumulationTest, LessNoiseIsLeft) {
  std::vector<PosedImage> images;
  for (int i = 0; i < kImages; ++i) images.push_back(noisy(i));
  const cv::Mat truth = clean(kImages - 1).pixels, shown = lent_after(images), last = images.back().pixels;
  cv::Mat model;
  cv::cvtColor(truth, model, cv::COLOR_BGR2GRAY);
  cv::erode(model > 0, model, {}, {-1, -1}, 4);
  EXPECT_NEAR(rms(last, truth, model), kNoise, 0.1 * kNoise);
  EXPECT_LT(rms(shown, truth, model), 0.8 * rms(last, truth, model));
}

TEST_F(AccumulationTest, WhatLooksDifferentNowIsShownAtOnce) {
  std::vector<PosedImage> images;
  for (int i = 0; i < kImages; ++i) images.push_back(clean(i));
  cv::cvtColor(images.back().pixels, images.back().pixels, cv::COLOR_BGR2RGB);
  const cv::Mat shown = lent_after(images), only = block_in(kImages - 1, 0);
  ASSERT_GT(cv::countNonZero(only), 100);
  EXPECT_LT(rms(shown, images.back().pixels, only), 1);
}

TEST_F(AccumulationTest, WhatMovesIsLeftAsItIs) {
  std::vector<PosedImage> images;
  const auto place = [](int i) { return 0.004 * i; };
  for (int i = 0; i < kImages; ++i) images.push_back(noisy(i, place(i)));
  const cv::Mat shown = lent_after(images), only = block_in(kImages - 1, place(kImages - 1));
  ASSERT_GT(cv::countNonZero(only), 100);
  EXPECT_EQ(cv::norm(shown, images.back().pixels, cv::NORM_INF, only), 0);
}

TEST_F(AccumulationTest, AnImageFromBeforeChangesNothing) {
  std::vector<PosedImage> images{noisy(0), noisy(2), noisy(1)};
  EXPECT_EQ(cv::norm(lent_after(images), images.back().pixels, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace foresight::accumulation_test
