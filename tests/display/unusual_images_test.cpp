// Images that nobody wishes for, kind by kind: a view that looks them up, and draws the shadows that they tell of, is
// no worse than one from textures alone.
#include <opencv2/imgproc.hpp>
#include <optional>

#include "display/predicted_view.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/lamp_light.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::unusual_images_test {
namespace {

class UnusualImages : public HeadlessTest {
 protected:
  struct Outcome {
    double error = 0;  ///< mean square, grey levels, of the pixels that were seen for certain
    double seen = 0;   ///< share of those that show the model
    bool lamp_known = false;
  };

  static Pose camera(int i) { return look_at({-0.9 + 0.04 * i, -0.8, 0.75}, {0.02 * i - 0.2, 0.05, 0.1}); }
  SceneState state(int i) const {
    SceneState out = state_of(*scene_);
    out.time = RobotTime{} + seconds(0.4 * i);
    Pose& block = out.T_world_node[kBlock];
    block.translation() = Eigen::Vector3d(-0.2 + 0.25 * std::sin(0.44 * i), -0.05 + 0.3 * std::cos(0.68 * i), 0.22);
    block.rotate(Eigen::AngleAxisd(0.4 * i, Eigen::Vector3d::UnitZ()));
    return out;
  }
  PosedImage image(int i, const Pose& T_world_camera, const Lens& lens, double gain = 1) const {
    return posed_photograph(*scene_, state(i), lens, T_world_camera, gain);
  }
  PosedImage lit(int i, const Pose& T_world_camera, const std::vector<Lamp>& lamps) const {
    return lit_photograph(*scene_, state(i), lens_, T_world_camera, lamps, 0.5, 4);
  }

  /// A view at `truth`'s pose and instant, after all of `frames`, judged by its pixels.
  Outcome view_of(const PosedImage& truth, const std::vector<PosedFrame>& frames, int images, bool shadows) const {
    TextureCore core(scene_, surface_, lens_, right_, {.memory_bytes = 24 << 20, .images = images, .shadows = shadows},
                     driver_.is_software);
    LatestTextures textures;
    LatestImages latest;
    Outcome out;
    for (const PosedFrame& frame : frames) {
      if (images > 0) core.look(frame, latest);
      const ExtractionReport report = images > 0 ? core.extract(textures) : core.process(frame, textures);
      out.lamp_known = report.lamp.lamp.has_value();
    }
    PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
    view.draw(truth.T_world_camera, truth.scene, textures.acquire(), latest.acquire());
    cv::Mat shown(lens_.height(), lens_.width(), CV_8UC4);  // as it is: what is uncertain does not count
    glGetTextureImage(view.picture().name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(4 * shown.total()),
                      shown.data);
    int model = 0, seen = 0;
    for (int y = 0; y < shown.rows; ++y)
      for (int x = 0; x < shown.cols; ++x) {
        const cv::Vec4b& pixel = shown.at<cv::Vec4b>(y, x);
        model += pixel[3] > 0;
        if (pixel[3] != 255) continue;
        ++seen;
        for (int c = 0; c < 3; ++c) {
          const double error = pixel[c] - truth.pixels.at<cv::Vec3b>(y, x)[c];
          out.error += error * error / 3;
        }
      }
    EXPECT_GT(seen, 4000);
    out.error /= std::max(seen, 1);
    out.seen = static_cast<double>(seen) / std::max(model, 1);
    return out;
  }

  /// Six pairs, the right camera half as bright and reddish.
  std::vector<PosedFrame> pairs(const Lens& right) {
    right_ = right;
    Pose T_left_right = Pose::Identity();
    T_left_right.translation().x() = 0.12;
    std::vector<PosedFrame> out;
    for (int i = 0; i < 6; ++i) {
      PosedImage reddish = image(i, camera(i) * T_left_right, right, 0.5);
      cv::multiply(reddish.pixels, cv::Scalar(0.7, 1.0, 1.3), reddish.pixels);
      out.push_back({image(i, camera(i), lens_), std::move(reddish)});
    }
    return out;
  }

  /// `most`: of the error from textures alone.
  void expect_no_worse(const PosedImage& truth, const std::vector<PosedFrame>& frames, double most = 1.02) const {
    const Outcome without = view_of(truth, frames, 0, false);
    for (const int images : {1, 6}) {
      SCOPED_TRACE(std::to_string(images) + " images looked up");
      const Outcome with = view_of(truth, frames, images, true);
      EXPECT_LE(with.error, most * without.error + 0.2);
      EXPECT_GE(with.seen, without.seen - 0.01);
    }
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  const Lens lens_ = small_lens("plumb_bob");
  std::optional<Lens> right_;
};

TEST_F(UnusualImages, OneAlone) {
  expect_no_worse(image(2, camera(2), lens_), {{image(0, camera(0), lens_), std::nullopt}});
}

TEST_F(UnusualImages, InTheWrongOrder) {
  std::vector<PosedFrame> frames;
  for (const int i : {3, 1, 0, 2, 5, 4}) frames.push_back({image(i, camera(i), lens_), std::nullopt});
  expect_no_worse(image(6, camera(6), lens_), frames);
}

// Half as bright, and reddish.
TEST_F(UnusualImages, OfTwoCamerasThatDifferInColourAndExposure) {
  expect_no_worse(image(7, camera(7), lens_), pairs(lens_));
}

// Of another size, too: textures have what the finer right camera shows, the newest left image that is looked up has
// not.
TEST_F(UnusualImages, OfTwoCamerasThatHaveLittleInCommon) {
  const Lens finer({.width = 120, .height = 90, .fx = 100, .fy = 101, .cx = 60, .cy = 43});
  expect_no_worse(image(7, camera(7), lens_), pairs(finer), 1.1);
}

TEST_F(UnusualImages, WithoutTexture) {
  const auto plain = [&](int i) {
    PosedImage out = image(i, camera(i), lens_);
    out.pixels.setTo(cv::Scalar(120, 130, 110));
    return out;
  };
  std::vector<PosedFrame> frames;
  for (int i = 0; i < 6; ++i) frames.push_back({plain(i), std::nullopt});
  expect_no_worse(plain(7), frames);
}

// Shadows hide behind what throws them: little tells where the lamp is.
TEST_F(UnusualImages, WithALampBehindTheCamera) {
  const std::vector<Lamp> lamps = {{camera(0).translation() + Eigen::Vector3d(-0.1, -0.1, 0.1), 0.05, {2, 1.8, 1.6}}};
  std::vector<PosedFrame> frames;
  for (int i = 0; i < 20; ++i) frames.push_back({lit(i, camera(0), lamps), std::nullopt});
  expect_no_worse(lit(21, camera(0), lamps), frames);
}

TEST_F(UnusualImages, WithSeveralLamps) {
  std::vector<Lamp> lamps;
  for (int i = 0; i < 4; ++i) lamps.push_back({{std::cos(1.6 * i), std::sin(1.6 * i), 1.2}, 0.05, {1, 1, 1}});
  std::vector<PosedFrame> frames;
  for (int i = 0; i < 20; ++i) frames.push_back({lit(i, camera(0), lamps), std::nullopt});
  const PosedImage truth = lit(21, camera(0), lamps);
  expect_no_worse(truth, frames);
  EXPECT_FALSE(view_of(truth, frames, 1, true).lamp_known) << "the report says that nothing was done";
}

}  // namespace
}  // namespace foresight::unusual_images_test
