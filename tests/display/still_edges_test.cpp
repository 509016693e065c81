// Edges where the view looks from where the newest image was taken: as that image has them, but of what has moved.
#include <opencv2/imgproc.hpp>

#include "display/predicted_view.hpp"
#include "pictures/view_alpha.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::still_edges_test {
namespace {

constexpr int kRim = 8;  // px of an image that are not looked up

class StillEdgesTest : public HeadlessTest, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    TextureCore core(scene_, surface_, lens_, std::nullopt, {.memory_bytes = 6 << 20, .even_exposure = false},
                     driver_.is_software);
    // From the side first, so that textures have colours of what the newest image sees for no certain.
    core.process({photo(look_at({-0.5, -1.1, 0.9}, {0.1, 0, 0.1}), 0), std::nullopt}, textures_);
    core.look({taken_, std::nullopt}, images_);
    core.extract(textures_);
  }
  PosedImage photo(const Pose& T_world_camera, double block_x) const {
    return posed_photograph(*scene_, state_of(*scene_, block_x), lens_, T_world_camera);
  }
  /// A view of its state, the second one: the first is what the passes are compiled with.
  cv::Mat view(const Pose& T_world_camera, double block_x, bool mixed) {
    PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
    view.mix_silhouettes(mixed);
    for (int i = 0; i < 2; ++i)
      view.draw(T_world_camera, state_of(*scene_, block_x), *textures_.acquire(), *images_.acquire());
    return view.read();
  }
  /// Pixels that differ by more than so many grey levels.
  static int differ(const cv::Mat& view, const cv::Mat& picture, int levels) {
    int out = 0;
    for (int y = kRim; y < view.rows - kRim; ++y)
      for (int x = kRim; x < view.cols - kRim; ++x) {
        const cv::Vec4b& v = view.at<cv::Vec4b>(y, x);
        const cv::Vec3b& p = picture.at<cv::Vec3b>(y, x);
        if (v[3] == 0) continue;
        out += cv::norm(cv::Vec3d(v[0], v[1], v[2]) - cv::Vec3d(p), cv::NORM_INF) > levels;
      }
    return out;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  const Lens lens_ = small_lens(GetParam());
  const PosedImage taken_ = photo(usual_view(), 0);
  LatestTextures textures_;
  LatestImages images_;
};

TEST_P(StillEdgesTest, AreAsTheImageHasThem) {
  const int without = differ(view(usual_view(), 0, false), taken_.pixels, 12);
  const int with = differ(view(usual_view(), 0, true), taken_.pixels, 12);
  EXPECT_GT(without, 40) << "of the edges that images are not trusted beside";
  EXPECT_LE(with, without / 6);
}

// Its old place shows what lies behind it, and nothing of the block's outline.
TEST_P(StillEdgesTest, OfWhatMovedStayWhereTheyAre) {
  const PosedImage then = photo(usual_view(), 0.2);
  const int without = differ(view(usual_view(), 0.2, false), then.pixels, 40);
  EXPECT_LE(differ(view(usual_view(), 0.2, true), then.pixels, 40), without);
}

TEST_P(StillEdgesTest, AreNotTakenFromElsewhere) {
  const PublishedImage& newest = *images_.acquire()->newest;
  Pose near = usual_view(), far = usual_view();
  near.translation().x() += 0.002;
  near.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()));
  far.translation().x() += 0.2;
  EXPECT_TRUE(StillEdges::may_be_seen(newest, near));
  EXPECT_FALSE(StillEdges::may_be_seen(newest, far));
}

INSTANTIATE_TEST_SUITE_P(Lenses, StillEdgesTest, testing::Values("pinhole", "plumb_bob", "wide_fisheye"),
                         [](const auto& kind) { return std::string(kind.param); });

}  // namespace
}  // namespace foresight::still_edges_test
