// The shadow of what moves is shown where it will be, once images have told where the lamp is.
#include <optional>
#include <vector>

#include "display/predicted_view.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/lamp_light.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::moving_shadow_test {
namespace {

const Lamp kLamp{{0.2, 0.4, 1.2}, 0.06, {3.0, 2.5, 2.0}};

class MovingShadow : public HeadlessTest {
 protected:
  SceneState state_at(double t) const {
    SceneState state = state_of(*scene_);
    state.time = RobotTime{} + seconds(t);
    Pose& block = state.T_world_node[kBlock];
    block.translation() = Eigen::Vector3d(-0.2 + 0.25 * std::sin(1.1 * t), -0.05 + 0.3 * std::cos(1.7 * t), 0.22);
    block.rotate(Eigen::AngleAxisd(t, Eigen::Vector3d::UnitZ()));
    return state;
  }
  PosedFrame frame(double t) const {
    return {lit_photograph(*scene_, state_at(t), lens_, camera_, {kLamp}, 0.55), std::nullopt};
  }
  /// What became of each image.
  struct Extracted {
    bool lamp_known = false;
    std::uint64_t texels = 0;
  };
  /// Mean squared error of a view of `t`, of the table, in grey levels.
  double error_in(const cv::Mat& shown, double t) const {
    const cv::Mat truth = frame(t).left.pixels;
    const reference::RayCaster caster(*scene_, state_at(t));
    double sum = 0;
    int count = 0;
    for (int y = 0; y < shown.rows; ++y)
      for (int x = 0; x < shown.cols; ++x) {
        const auto hit = caster.cast(camera_.translation(), camera_.linear() * *lens_.unproject({x, y}), 0.01);
        if (!hit || hit->node != kTable || shown.at<cv::Vec4b>(y, x)[3] != 255) continue;
        for (int c = 0; c < 3; ++c) {
          const double error = shown.at<cv::Vec4b>(y, x)[c] - truth.at<cv::Vec3b>(y, x)[c];
          sum += error * error;
          ++count;
        }
      }
    EXPECT_GT(count, 10000);
    return sum / count;
  }
  /// Of a view of `t`; the last image is older.
  double error_of(TextureOptions options, double t, std::vector<Extracted>& images) const {
    TextureCore core(scene_, surface_, lens_, std::nullopt, options, driver_.is_software);
    LatestTextures textures;
    LatestImages image;
    for (int i = 0; i < 30; ++i) {
      const PosedFrame f = frame(0.4 * i);
      core.look(f, image);
      const ExtractionReport report = core.extract(textures);
      images.push_back({report.lamp.lamp.has_value(), report.texels_written});
    }
    PredictedView view = new_view();
    view.draw(camera_, state_at(t), *textures.acquire(), *image.acquire());
    return error_in(view.read(), t);
  }
  PredictedView new_view() const {
    return {std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_};
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  const Lens lens_ = small_lens("pinhole");
  const Pose camera_ = usual_view();
};

TEST_F(MovingShadow, IsShownWhereItWillBe) {
  constexpr double kShown = 0.4 * 29 + 0.5;
  std::vector<Extracted> images, not_asked;
  const double with = error_of({.memory_bytes = 12 << 20}, kShown, images);
  const double without = error_of({.memory_bytes = 12 << 20, .shadows = false}, kShown, not_asked);
  EXPECT_TRUE(images.back().lamp_known);
  EXPECT_FALSE(not_asked.back().lamp_known);
  EXPECT_LT(with, 0.3 * without) << with << " against " << without;

  // The first image was extracted as a whole. When the lamp is known, only what its shadows may have reached is carried
  // over.
  for (std::size_t i = 1; i < images.size(); ++i) {
    const bool becomes_known = images[i].lamp_known && !images[i - 1].lamp_known;
    EXPECT_LT(images[i].texels, images[0].texels / (becomes_known ? 1.5 : 4)) << "image " << i;
  }
}

// Most of them come from images before, and the newest one does not renew those at once.
TEST_F(MovingShadow, LeavesTexturesOnceTheLampIsKnown) {
  TextureCore core(scene_, surface_, lens_, std::nullopt, {.memory_bytes = 12 << 20}, driver_.is_software);
  LatestTextures textures;
  LatestImages image;
  PredictedView view = new_view();
  constexpr double kShown = 2.5;
  std::optional<double> before;
  for (int i = 0; i < 30; ++i) {
    core.look(frame(0.4 * i), image);
    const bool lamp_known = core.extract(textures).lamp.lamp.has_value();
    view.draw(camera_, state_at(kShown), *textures.acquire());
    const double error = error_in(view.read(), kShown);
    if (lamp_known) {
      ASSERT_TRUE(before) << "known from the first image on";
      EXPECT_LT(error, 0.3 * *before) << error << " against " << *before << ", image " << i;
      return;
    }
    before = error;
  }
  FAIL() << "the lamp was not found";
}

TEST_F(MovingShadow, PreparingForItChangesNoPicture) {
  const SceneState state = state_at(0.5);
  std::vector<cv::Mat> shown;
  for (const bool prepares : {false, true}) {
    TextureCore core(scene_, surface_, lens_, std::nullopt, {.memory_bytes = 12 << 20}, driver_.is_software);
    PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
    if (prepares) view.prepare();
    LatestTextures textures;
    LatestImages image;
    for (const double t : {0.0, 0.4}) {
      core.look(frame(t), image);
      core.extract(textures);
      view.draw(camera_, state, *textures.acquire());
      shown.push_back(view.read());
    }
    view.draw(camera_, state, *textures.acquire(), *image.acquire());
    shown.push_back(view.read());
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(cv::norm(shown[i], shown[i + 3], cv::NORM_INF), 0) << "picture " << i;
}

}  // namespace
}  // namespace foresight::moving_shadow_test
