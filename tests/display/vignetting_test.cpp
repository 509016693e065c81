// A lens that leaves less of the light towards the image's rim, and what views show there.
#include "display/predicted_view.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::vignetting_view_test {
namespace {

constexpr double kInCorner = 0.5;  // of the value in the middle

/// Share of half the image's diagonal, squared.
double radius2(const cv::Mat& image, int x, int y) {
  const double half_x = 0.5 * (image.cols - 1), half_y = 0.5 * (image.rows - 1);
  const double dx = x - half_x, dy = y - half_y;
  return (dx * dx + dy * dy) / (half_x * half_x + half_y * half_y);
}

/// Whose images have pages enough that vignetting is soon known.
Lens large_lens() {
  Lens::Parameters p;
  p.width = 400, p.height = 300;
  p.fx = p.fy = 330, p.cx = 199.5, p.cy = 149.5;
  return Lens(p);
}

class Vignetting : public HeadlessTest {
 protected:
  static constexpr int kImages = 20;
  static Pose camera(int i) {
    return look_at({-0.8 + 0.02 * i, -0.8 + 0.1 * (i % 3), 0.75},
                   {0.4 * std::sin(0.9 * i), 0.3 * std::cos(1.3 * i), 0.1});
  }
  SceneState state(int i) const {
    SceneState out = state_of(*scene_);
    out.time = RobotTime{} + seconds(0.4 * i);
    return out;
  }
  PosedImage image(int i) const {
    PosedImage out = posed_photograph(*scene_, state(i), lens_, camera(i));
    for (int y = 0; y < out.pixels.rows; ++y)
      for (int x = 0; x < out.pixels.cols; ++x) {
        cv::Vec3b& pixel = out.pixels.at<cv::Vec3b>(y, x);
        for (int c = 0; c < 3; ++c)
          pixel[c] = cv::saturate_cast<uchar>(pixel[c] * std::pow(kInCorner, radius2(out.pixels, x, y)));
      }
    return out;
  }

  void see_all(int images_looked_up) {
    TextureCore core(scene_, surface_, lens_, std::nullopt,
                     {.memory_bytes = 64 << 20, .images = images_looked_up, .shadows = false}, driver_.is_software);
    for (int i = 0; i < kImages; ++i) {
      const PosedFrame frame{image(i), std::nullopt};
      if (images_looked_up > 0) {
        core.look(frame, images_);
        core.extract(textures_);
      } else {
        core.process(frame, textures_);
      }
    }
  }

  /// Mean of shown - true, grey levels, as seen after all images from where one of them was taken: of the outer fifth
  /// of the picture's radius, and of its inner half.
  struct Brighter {
    double outside = 0, inside = 0;
  };
  Brighter compared_with(const PosedImage& truth, bool has_rim) {
    PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
    view.show_vignetting(has_rim);
    view.draw(truth.T_world_camera, truth.scene, textures_.acquire(), images_.acquire());
    const cv::Mat shown = view.read();
    Brighter sum;
    int outside = 0, inside = 0;
    for (int y = 0; y < shown.rows; ++y)
      for (int x = 0; x < shown.cols; ++x) {
        const auto& pixel = shown.at<cv::Vec4b>(y, x);
        const auto& truth_pixel = truth.pixels.at<cv::Vec3b>(y, x);
        if (pixel[3] != 255) continue;
        const double difference = pixel[1] - truth_pixel[1];
        const double r2 = radius2(shown, x, y);
        if (r2 > 0.64) sum.outside += difference, ++outside;
        if (r2 < 0.25) sum.inside += difference, ++inside;
      }
    EXPECT_GT(outside, 500);
    EXPECT_GT(inside, 1000);
    return {sum.outside / std::max(outside, 1), sum.inside / std::max(inside, 1)};
  }

  void expect_rim() {
    const PosedImage truth = image(kImages / 2);
    const Brighter as_camera = compared_with(truth, true), even = compared_with(truth, false);
    EXPECT_NEAR(as_camera.outside, 0, 3);
    EXPECT_NEAR(as_camera.inside, 0, 2);
    EXPECT_GT(even.outside, 20);
    EXPECT_NEAR(even.inside, as_camera.inside, 12);
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  const Lens lens_ = large_lens();
  LatestTextures textures_;
  LatestImages images_;
};

TEST_F(Vignetting, AViewOfTexturesHasTheRimThatItsCameraHas) {
  see_all(0);
  expect_rim();
}

TEST_F(Vignetting, AViewOfTheNewestImagesHasTheRimThatItsCameraHas) {
  see_all(1);
  expect_rim();
}

}  // namespace
}  // namespace foresight::vignetting_view_test
