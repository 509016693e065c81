// A view that is drawn with levels of detail shows the textures of the mesh itself.
#include "display/predicted_view.hpp"

#include <opencv2/imgproc.hpp>

#include "tests/support/fine_scene.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::view_levels_test {
namespace {

class ViewLevelsTest : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    scene_ = fine_scene(1000);
    surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
    auto levels = std::make_shared<const SceneLevels>(*scene_, surface_->patch_of_triangle);
    buffers_ = std::make_shared<const gl::LevelBuffers>(*scene_, std::move(levels));
    core_ = std::make_unique<TextureCore>(scene_, surface_, lens_, std::nullopt,
                                          TextureOptions{.memory_bytes = 6 << 20}, driver_.is_software);
    image_ = posed_photograph(*scene_, state_of(*scene_), lens_, from_);
    core_->process({image_, std::nullopt}, latest_);
  }
  PredictedView view(const std::optional<LevelSettings>& settings, const Lens& lens) const {
    std::optional<ViewLevels> levels;
    if (settings) levels = {buffers_, *settings};
    return {std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens,
            ViewPrograms::two, levels};
  }
  cv::Mat drawn(PredictedView& view, const Pose& from) const {
    const TextureLease lease = latest_.acquire();
    view.draw(from, state_of(*scene_), *lease);
    return view.read();
  }
  /// Of pixels that show a camera's colour in both; and the share of those of the first that the second has, too, but
  /// for those within `rim` px of what the first does not show.
  static std::pair<double, double> compared(const cv::Mat& a, const cv::Mat& b, int rim = 0) {
    cv::Mat first, second, inner, kept;
    cv::inRange(a, cv::Scalar(0, 0, 0, 255), cv::Scalar::all(255), first);
    cv::inRange(b, cv::Scalar(0, 0, 0, 255), cv::Scalar::all(255), second);
    cv::erode(first, inner, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * rim + 1, 2 * rim + 1}), {-1, -1}, 1,
              cv::BORDER_CONSTANT, cv::Scalar::all(255));
    kept = inner & second;
    const double share = static_cast<double>(cv::countNonZero(kept)) / cv::countNonZero(inner);
    const cv::Mat both = first & second;
    const double squares = std::pow(cv::norm(a, b, cv::NORM_L2, both), 2) / 3;
    return {10 * std::log10(255.0 * 255.0 * cv::countNonZero(both) / std::max(squares, 1e-9)), share};
  }

  const Lens lens_ = small_lens("pinhole");
  const Pose from_ = look_at({-1.2, -0.7, 0.9}, {0.1, 0.3, 0.2});
  std::shared_ptr<const SceneModel> scene_;
  std::shared_ptr<const SurfacePatches> surface_;
  std::shared_ptr<const gl::LevelBuffers> buffers_;
  std::unique_ptr<TextureCore> core_;
  LatestTextures latest_;
  PosedImage image_;
};

// The same textures, extracted once for the mesh itself, at every level. Outlines may move by as much as levels may
// err.
TEST_F(ViewLevelsTest, TexturesFollowToEveryLevel) {
  const Pose beside = look_at({-1.1, -0.9, 0.8}, {0.1, 0.3, 0.2});
  for (const char* kind : {"pinhole", "plumb_bob"}) {
    const Lens lens = small_lens(kind);
    PredictedView full = view(std::nullopt, lens);
    const cv::Mat expected = drawn(full, beside);
    std::size_t triangles = scene_->triangle_count();
    for (const double px : {0.0, 1.0, 3.0}) {
      PredictedView coarse = view(LevelSettings{.rule = LevelRule::by_size, .px = px}, lens);
      const auto [db, share] = compared(expected, drawn(coarse, beside), static_cast<int>(px) + 1);
      const auto drawn_triangles = static_cast<std::size_t>(coarse.levels()->last().work.triangles);
      std::printf("%s, %.1f px: %zu triangles, %.1f dB, %.3f of the pixels but for the rim\n", kind, px,
                  drawn_triangles, db, share);
      EXPECT_GT(db, px == 0 ? 50 : px == 1 ? 34 : 28) << kind << ", " << px << " px";
      EXPECT_GT(share, px == 0 ? 0.999 : 0.995) << kind << ", " << px << " px";
      EXPECT_TRUE(px == 0 || drawn_triangles < triangles) << px;
      triangles = drawn_triangles;
    }
  }
}

TEST_F(ViewLevelsTest, WhatTremblesStandsStill) {
  PredictedView coarse = view(LevelSettings{.rule = LevelRule::by_size}, lens_);
  const TextureLease lease = latest_.acquire();
  const auto at = [&](double moved) {
    SceneState state = state_of(*scene_);
    state.T_world_node[0].translation().x() += moved;
    coarse.draw(from_, state, *lease);
    return coarse.read();
  };
  const cv::Mat first = at(0);
  EXPECT_EQ(cv::norm(first, at(1e-4), cv::NORM_INF), 0) << "a hundredth of a pixel";
  EXPECT_GT(cv::norm(first, at(0.02), cv::NORM_INF), 0) << "two pixels";
}

TEST_F(ViewLevelsTest, ViewsOfNoUseAreDrawnInFull) {
  PredictedView coarse = view(LevelSettings{.rule = LevelRule::by_size, .px = 1}, lens_);
  PredictedView full = view(std::nullopt, lens_);
  Pose lost = from_;
  lost.translation().y() = std::numeric_limits<double>::quiet_NaN();
  drawn(coarse, lost);
  EXPECT_FALSE(coarse.levels()->last().is_usable_view);
  EXPECT_GT(compared(drawn(full, from_), drawn(coarse, from_)).second, 0.9) << "and it recovers";
}

}  // namespace
}  // namespace foresight::view_levels_test
