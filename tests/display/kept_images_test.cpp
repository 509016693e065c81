// Images that are kept beside the newest one: gloss is shown as from the eye's side, and nothing that is out of date.
#include <functional>
#include <opencv2/imgproc.hpp>

#include "display/predicted_view.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::kept_images_view_test {
namespace {

class KeptImagesView : public HeadlessTest {
 protected:
  static constexpr int kImages = 8;
  static constexpr double kGloss = 0.4;  // linear light, from the first image's side to the last one's

  /// From the right to the left, half a metre.
  static Pose camera(double i) { return look_at({-1.0, -0.45 + 0.06 * i, 0.8}, {0.02, 0, 0.1}); }
  SceneState state(double i, double block_x = 0) const {
    SceneState out = state_of(*scene_, block_x);
    out.time = RobotTime{} + seconds(0.1 * i);
    return out;
  }
  /// Shines the more, the further to the left it is seen from.
  PosedImage glossy(double i, double block_x = 0) const { return shining(i, camera(i), block_x); }
  PosedImage shining(double i, const Pose& T_world_camera, double block_x = 0) const {
    PosedImage out = posed_photograph(*scene_, state(i, block_x), lens_, T_world_camera);
    const double shine = kGloss * (T_world_camera.translation().y() + 0.45) / (0.06 * kImages);
    out.pixels.forEach<cv::Vec3b>([&](cv::Vec3b& pixel, const int*) {
      if (pixel == cv::Vec3b(0, 0, 0)) return;
      for (int c = 0; c < 3; ++c)
        pixel[c] = cv::saturate_cast<uchar>(255 * std::sqrt(std::pow(pixel[c] / 255.0, 2) + shine));
    });
    return out;
  }

  void look(const std::function<PosedFrame(int)>& frame, int kept) {
    TextureCore core(scene_, surface_, lens_, right_,
                     {.memory_bytes = 64 << 20, .images = kept, .even_exposure = false}, driver_.is_software);
    for (int i = 0; i < kImages; ++i) {
      core.look(frame(i), images_);
      core.extract(textures_);
    }
  }
  cv::Mat view_from(const Pose& T_world_eye, const SceneState& state) const {
    PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
    view.mix_silhouettes(false);
    view.draw(T_world_eye, state, textures_.acquire(), images_.acquire());
    return view.read();
  }
  /// Seen from where the first images were taken, after all of them.
  cv::Mat look_back(const std::function<PosedFrame(int)>& frame, int kept) {
    look(frame, kept);
    return view_from(camera(0.5), state(kImages));
  }
  /// Mean absolute difference of what counts as seen, grey levels; `only`: where that is not 0.
  static double difference(const cv::Mat& shown, const cv::Mat& truth, const cv::Mat& only = {}) {
    double sum = 0;
    int count = 0;
    for (int y = 0; y < shown.rows; ++y)
      for (int x = 0; x < shown.cols; ++x) {
        const cv::Vec4b& pixel = shown.at<cv::Vec4b>(y, x);
        if (pixel[3] != 255 || (!only.empty() && only.at<uchar>(y, x) == 0)) continue;
        ++count;
        const uchar* true_pixel = truth.ptr<uchar>(y) + x * truth.channels();
        for (int c = 0; c < 3; ++c) sum += std::abs(pixel[c] - true_pixel[c]) / 3.0;
      }
    EXPECT_GT(count, 100);
    return sum / std::max(count, 1);
  }
  /// The pixels of a view from there that show the node, but for its rim.
  cv::Mat pixels_of(int node, const Pose& T_world_eye, const SceneState& state) const {
    SceneState without = state;
    without.T_world_node[static_cast<std::size_t>(node)].translation().z() = -50;
    cv::Mat difference, out;
    cv::absdiff(photograph(*scene_, state, lens_, T_world_eye), photograph(*scene_, without, lens_, T_world_eye),
                difference);
    cv::cvtColor(difference, out, cv::COLOR_BGR2GRAY);
    cv::erode(out, out, {}, {-1, -1}, 2);
    return out;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  const Lens lens_ = small_lens("plumb_bob");
  std::optional<Lens> right_;
  LatestTextures textures_;
  LatestImages images_;
};

TEST_F(KeptImagesView, ShowGlossAsFromTheEyesSide) {
  const auto frame = [&](int i) { return PosedFrame{glossy(i), std::nullopt}; };
  const cv::Mat truth = glossy(0.5).pixels;
  const double newest = difference(look_back(frame, 1), truth), kept = difference(look_back(frame, kImages), truth);
  EXPECT_GT(newest, 30);
  EXPECT_LT(kept, 0.5 * newest) << "what the newest image does not see stays as it is";
}

TEST_F(KeptImagesView, WhatIsOutOfDateIsNeverShown) {
  // In the last images red and blue have changed places: something else lies there now.
  const auto frame = [&](int i) {
    PosedFrame out{posed_photograph(*scene_, state(i), lens_, camera(i)), std::nullopt};
    if (i >= kImages - 2) cv::cvtColor(out.left.pixels, out.left.pixels, cv::COLOR_BGR2RGB);
    return out;
  };
  const cv::Mat newest = look_back(frame, 1), kept = look_back(frame, kImages);
  for (const int node : {kBox, kBlock})
    EXPECT_LT(difference(kept, newest, pixels_of(node, camera(0.5), state(0))), 0.1) << node;
}

TEST_F(KeptImagesView, WhatOnlyPassedIsNeverShown) {
  const auto frame = [&](int i) {
    PosedFrame out{posed_photograph(*scene_, state(i), lens_, camera(i)), std::nullopt};
    if (i == 0) cv::cvtColor(out.left.pixels, out.left.pixels, cv::COLOR_BGR2RGB);
    return out;
  };
  const cv::Mat newest = look_back(frame, 1), kept = look_back(frame, kImages);
  cv::Mat seen_from_first = photograph(*scene_, state(0), lens_, camera(0.5));
  EXPECT_LT(difference(kept, seen_from_first), difference(newest, seen_from_first) + 1);
}

TEST_F(KeptImagesView, WhileTheCameraStandsEvenWhiteLightIsAChange) {
  // Goes to and fro, and stands at last; then somebody switches a lamp on.
  const auto frame = [&](int i) {
    PosedFrame out{posed_photograph(*scene_, state(i), lens_, camera(std::min(i, 3))), std::nullopt};
    if (i == kImages - 1) out.left.pixels = shining(i, camera(3)).pixels;
    return out;
  };
  const cv::Mat newest = look_back(frame, 1), kept = look_back(frame, kImages);
  EXPECT_LT(difference(kept, newest), 0.3);
}

TEST_F(KeptImagesView, WhatHasMovedIsShownByTheNewestAlone) {
  // The block moves before the last image: older ones show it with the light from elsewhere.
  const auto frame = [&](int i) { return PosedFrame{glossy(i, i == kImages - 1 ? 0.15 : 0), std::nullopt}; };
  const SceneState now = state(kImages, 0.15);
  look(frame, 1);
  const cv::Mat newest = view_from(camera(0.5), now);
  look(frame, kImages);
  const cv::Mat kept = view_from(camera(0.5), now);
  EXPECT_EQ(difference(kept, newest, pixels_of(kBlock, camera(0.5), now)), 0);
}

TEST_F(KeptImagesView, TheRightEyeHasTheRightCamerasImage) {
  right_ = lens_;
  Pose T_left_right = Pose::Identity();
  T_left_right.translation().x() = 0.12;
  const auto frame = [&](int i) { return PosedFrame{glossy(i), shining(i, camera(i) * T_left_right)}; };
  const Pose T_world_eye = camera(kImages - 1) * T_left_right;
  const cv::Mat truth = shining(kImages, T_world_eye).pixels;
  look(frame, 1);
  const double left = difference(view_from(T_world_eye, state(kImages)), truth);
  look(frame, 2);
  const double right = difference(view_from(T_world_eye, state(kImages)), truth);
  EXPECT_LT(right, 0.5 * left);
}

}  // namespace
}  // namespace foresight::kept_images_view_test
