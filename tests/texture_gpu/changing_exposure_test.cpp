// Cameras that open and close: what the textures show of surfaces whose true paint is known.
#include <gtest/gtest.h>

#include <map>
#include <opencv2/imgproc.hpp>

#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"
#include "texture_gpu/texture_readback.hpp"

namespace foresight::changing_exposure_test {
namespace {

class ChangingExposure : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (!context_) return;
    core_ = std::make_unique<TextureCore>(scene_, surface_, lens_, std::nullopt,
                                          TextureOptions{.memory_bytes = 40 << 20}, driver_.is_software);
  }
  static Pose orbit(int i) { return look_at({-1.0 + 0.04 * i, -0.45 - 0.02 * i, 0.8}, {0.02, 0, 0.1}); }
  /// Of a corner of the table only.
  static Pose elsewhere() { return look_at({-1.0, -0.45, 0.8}, {-0.3, -0.75, 0}); }

  /// The photograph of each view is taken once.
  PosedFrame frame(const Pose& view, double gain) {
    constexpr double kUnclipped = 0.95;
    auto& photograph = photographs_[view.translation().x()];
    if (photograph.pixels.empty()) photograph = posed_photograph(*scene_, state_of(*scene_), lens_, view, kUnclipped);
    PosedFrame out{photograph, std::nullopt};
    out.left.pixels.release();  // else the photograph itself would be changed
    photograph.pixels.convertTo(out.left.pixels, -1, gain / kUnclipped);
    return out;
  }
  PosedFrame flat_frame(const Pose& view, const cv::Scalar& bgr) {
    PosedFrame out = frame(view, 1);
    out.left.pixels = cv::Mat(out.left.pixels.size(), CV_8UC3, bgr);
    return out;
  }
  ExtractionReport process(const PosedFrame& frame) { return core_->process(frame, latest_); }

  /// Core texels that a camera saw, beside what a camera of this gain would see of the paint there.
  struct Error {
    int texels = 0, white = 0;  ///< white: shown as 255
    double mean = 0, worst = 0;
    int grey = 0;  ///< channels, three a texel, that are darker than they should be by more than 15
  };
  Error error(double gain, const std::vector<int>& nodes = {kTable, kBox, kBlock, kBoard}) const {
    const TextureReadback textures(*latest_.acquire(), surface_);
    const SceneState state = state_of(*scene_);
    Error out;
    for (int i = 0; i < static_cast<int>(surface_->charts.size()); ++i) {
      const auto chart = textures.chart(i);
      if (!chart || std::find(nodes.begin(), nodes.end(), chart->node()) == nodes.end()) continue;
      for (int y = 0; y < chart->height(); ++y)
        for (int x = 0; x < chart->width(); ++x) {
          const cv::Vec4b shown = chart->colours.at<cv::Vec4b>(y, x);
          const auto p = chart->point(x, y);
          if (shown[3] != 255 || !p || !chart->core(x, y) || at_contact(state, chart->node(), *p, 0.04)) continue;
          const Eigen::Vector3d paint_there = paint(chart->node(), *p);
          for (int c = 0; c < 3; ++c) {
            const double want = std::min(255.0, 255 * gain * paint_there[c]);
            const double off = shown[c] - want;
            out.mean += std::abs(off);
            out.worst = std::max(out.worst, std::abs(off));
            out.white += shown[c] == 255;
            out.grey += off < -15;
          }
          ++out.texels;
        }
    }
    out.mean /= std::max(1, 3 * out.texels);
    return out;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  std::map<double, PosedImage> photographs_;
  /// Twice as large as in other tests: a gain takes 30 pages that were seen before.
  Lens lens_ = [] {
    Lens::Parameters p = small_lens("plumb_bob").parameters();
    p.width *= 2, p.height *= 2;
    p.fx *= 2, p.fy *= 2, p.cx *= 2, p.cy *= 2;
    return Lens(p);
  }();
  LatestTextures latest_;
  std::unique_ptr<TextureCore> core_;
};

// The first image is bright; what is white in it has its colour in the second, darker one.
TEST_F(ChangingExposure, WhatWasNotClippedInItsImageIsNotClippedInTheTexture) {
  process(frame(orbit(0), 2.2));
  const Error bright = error(2.2);
  EXPECT_GT(bright.white, bright.texels / 4) << "this test needs highlights";
  EXPECT_LT(bright.mean, 2);
  for (int i = 1; i <= 5; ++i) {
    const double gain = 2.2 - 0.3 * i;
    process(frame(orbit(i % 3), gain));
    const Error now = error(gain);
    EXPECT_LT(now.mean, 2.6) << gain;
    EXPECT_LT(now.grey, now.texels / 20) << gain << ": a few at silhouettes";
  }
}

// An open camera shows white as white, and forgets no colour over it.
TEST_F(ChangingExposure, WhiteKeepsTheColourThatWasKnown) {
  for (int i = 0; i < 3; ++i) process(frame(orbit(0), 0.9));
  for (const double gain : {1.3, 1.9, 2.4}) {
    process(frame(orbit(1), gain));
    const Error now = error(gain);
    EXPECT_LT(now.mean, 3) << gain;
    EXPECT_LT(now.grey, 0.03 * 3 * now.texels) << gain << ": a few at silhouettes";
  }
  EXPECT_GT(error(2.4).white, 1000) << "this test needs highlights";
  // Closed again, and all but the table's end out of sight.
  process(frame(elsewhere(), 0.9));
  const Error after = error(0.9, {kBlock, kBox, kBoard});
  EXPECT_GT(after.texels, 1000);
  EXPECT_LT(after.mean, 4);
  EXPECT_LT(after.grey, 0.01 * 3 * after.texels);
}

// What was known shows through a flash, a covered lens and a picture of another world.
TEST_F(ChangingExposure, OneBadImageIsForgottenWithTheNext) {
  const std::pair<const char*, cv::Scalar> bad[] = {{"white", {255, 255, 255}}, {"black", {0, 0, 0}}};
  for (int i = 0; i < 3; ++i) process(frame(orbit(i), 1));
  const double before = error(1).mean;
  for (const auto& [name, colour] : bad) {
    process(flat_frame(orbit(1), colour));
    // Shown as it came in.
    const TextureReadback textures(*latest_.acquire(), surface_);
    int off = 0, all = 0;
    for (int i = 0; i < static_cast<int>(surface_->charts.size()); ++i)
      if (const auto chart = textures.chart(i))
        for (const cv::Vec4b& c : cv::Mat_<cv::Vec4b>(chart->colours))
          if (c[3] == 255) ++all, off += std::abs(c[1] - colour[1]) > 3;
    EXPECT_LT(off, all / 5) << name;
    // What the next image does not see is as it was, or nearly.
    process(frame(elsewhere(), 1));
    process(frame(elsewhere(), 1));
    const Error after = error(1, {kBlock, kBox, kBoard});
    EXPECT_GT(after.texels, 1000) << name;
    EXPECT_LT(after.mean, before + 6) << name;
    process(frame(orbit(0), 1));
    EXPECT_LT(error(1, {kBlock, kBox, kBoard}).mean, before + 1) << name;
  }
}

TEST_F(ChangingExposure, ColourCastsAndNoiseBreakNothing) {
  for (int i = 0; i < 2; ++i) process(frame(orbit(i), 1));
  PosedFrame cast = frame(orbit(2), 1);
  cv::multiply(cast.left.pixels, cv::Scalar(0.3, 0.8, 2), cast.left.pixels);
  process(cast);
  PosedFrame noise = frame(orbit(2), 1);
  cv::theRNG().state = 4;
  cv::randu(noise.left.pixels, 0, 256);
  process(noise);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(std::exp(process(frame(orbit(2), 1)).log_gain), 1, 0.03);
  EXPECT_LT(error(1).mean, 3);
}

TEST_F(ChangingExposure, StartsInTheDarkOrInTheWhite) {
  for (const cv::Scalar& first : {cv::Scalar::all(0), cv::Scalar::all(255)}) {
    TextureCore core(scene_, surface_, lens_, std::nullopt, {.memory_bytes = 40 << 20}, driver_.is_software);
    core.process(flat_frame(orbit(0), first), latest_);
    for (int i = 0; i < 2; ++i) core.process(frame(orbit(i), 1), latest_);
    EXPECT_LT(error(1).mean, 4) << first[0];
  }
}

// Coming closer, charts get finer and their pages new: their brightness is still known.
TEST_F(ChangingExposure, TheGainIsKnownWhenResolutionsChange) {
  for (int i = 0; i < 2; ++i) process(frame(orbit(i), 1));
  double gain = 1;
  for (const double nearer : {0.75, 0.55, 0.4}) {
    gain *= 0.8;
    const Pose view = look_at(Eigen::Vector3d(-1.0, -0.45, 0.8) * nearer, {0.02, 0, 0.1});
    EXPECT_NEAR(std::exp(process(frame(view, gain)).log_gain), gain, 0.03) << nearer;
  }
}

// A hundred thousand pages later the gain has not crept away.
TEST_F(ChangingExposure, TheGainDoesNotDrift) {
  for (int i = 0; i < 240; ++i) {
    const double gain = 1.2 + 0.7 * std::sin(0.11 * i);
    const ExtractionReport report = process(frame(orbit(i % 7), gain));
    if (i % 20 == 19) {
      EXPECT_NEAR(report.log_gain, std::log(gain / 1.2), 0.05) << i;
    }
  }
}

}  // namespace
}  // namespace foresight::changing_exposure_test
