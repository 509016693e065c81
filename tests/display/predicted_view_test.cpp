#include "display/predicted_view.hpp"

#include <map>

#include "tests/display/reference_view.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::predicted_view_test {
namespace {

class PredictedViewTest : public HeadlessTest {
 protected:
  void extract(const std::vector<Pose>& views, const char* lens = "pinhole", double gain = 1) {
    if (!core_)
      core_ = std::make_unique<TextureCore>(scene_, surface_, small_lens(lens), std::nullopt,
                                            TextureOptions{.memory_bytes = 6 << 20}, driver_.is_software);
    for (const Pose& view : views)
      core_->process({posed_photograph(*scene_, state_of(*scene_), small_lens(lens), view, gain), std::nullopt},
                     latest_);
  }
  /// Its pixels are what is looked up.
  PredictedView view_through(const Lens& lens) const {
    PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens);
    view.mix_silhouettes(false);
    return view;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  LatestTextures latest_;
  std::unique_ptr<TextureCore> core_;
};

class ViewOfLenses : public PredictedViewTest, public testing::WithParamInterface<const char*> {};

TEST_P(ViewOfLenses, EveryPixelIsThatOfTheReference) {
  extract({usual_view(), look_at({-0.8, -0.6, 0.7}, {0, 0, 0.1})}, "pinhole", 0.9);
  const Lens lens = small_lens(GetParam());
  PredictedView view = view_through(lens);
  const TextureLease lease = latest_.acquire();
  const reference::Generation generation(*lease, surface_->charts.size());
  const reference::AtlasPixels pixels(*lease->colours);
  const SceneState predicted = state_of(*scene_, 0.12);  // the block has moved on
  // As the camera stood, from elsewhere, near, and so far that coarser levels are shown.
  int compared = 0, borderline = 0, other_state = 0, states[256] = {};
  double worst = 0;
  for (const Pose& T_world_camera :
       {usual_view(), look_at({-0.2, -1.1, 0.9}, {0.1, 0, 0.1}), look_at({-0.4, -0.4, 0.3}, {0.05, 0.1, 0.1}),
        look_at({-3, -1.5, 2.2}, {0, 0, 0.1})}) {
    view.draw(T_world_camera, predicted, *lease);
    const cv::Mat picture = view.read();
    ASSERT_EQ(picture.type(), CV_8UC4);
    const reference::View reference(*scene_, predicted, *surface_, generation, pixels);
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) {
        const reference::ViewPixel expected = reference.at(lens, T_world_camera, {x, y});
        if (expected.borderline) {
          ++borderline;
          continue;
        }
        ++compared;
        const cv::Vec4b got = picture.at<cv::Vec4b>(y, x);
        const int state = static_cast<int>(std::lround(255 * expected.rgba.w()));
        other_state += got[3] != state;
        ++states[got[3]];
        const Eigen::Vector3d rgb(got[2], got[1], got[0]);
        if (got[3] == state) worst = std::max(worst, (rgb - 255 * expected.rgba.head<3>()).cwiseAbs().maxCoeff());
      }
  }
  EXPECT_GT(compared, 4 * borderline);
  EXPECT_GT(states[255], 2000);
  EXPECT_GT(states[128], 500);
  EXPECT_GT(states[0], 1000);
  EXPECT_EQ(states[0] + states[64] + states[128] + states[255], compared) << "there are four states";
  // Texels' places are floats: where the filter's weight lies at a border between seen and not.
  EXPECT_LE(other_state, compared / 2000);
  // Half a step of rounding, and places a hundredth of a texel off.
  EXPECT_LT(worst, 2);
}

INSTANTIATE_TEST_SUITE_P(Lenses, ViewOfLenses, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

TEST_P(ViewOfLenses, TwoProgramsDrawWhatOneDraws) {
  extract({usual_view()}, "pinhole", 0.9);
  PredictedView view = view_through(small_lens(GetParam()));
  PredictedView single(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_),
                       small_lens(GetParam()), ViewPrograms::single);
  single.mix_silhouettes(false);
  const TextureLease lease = latest_.acquire();
  int off = 0;
  for (const Pose& T_world_camera :
       {look_at({-0.4, -0.4, 0.3}, {0.05, 0.1, 0.1}), look_at({-3, -1.5, 2.2}, {0, 0, 0.1})}) {
    view.draw(T_world_camera, state_of(*scene_, 0.12), *lease);
    single.draw(T_world_camera, state_of(*scene_, 0.12), *lease);
    cv::Mat difference;
    cv::absdiff(view.read(), single.read(), difference);
    off += cv::countNonZero(difference.reshape(1) > 1);  // compiled apart, they may round differently
  }
  EXPECT_LE(off, 8);
}

// The loop closed: photographed, extracted, shown again from the same place, it is the photograph.
// In bands, each when a gate lets it, it is the same picture.
TEST_P(ViewOfLenses, BandsAreOnePicture) {
  extract({usual_view(), look_at({-0.8, -0.6, 0.7}, {0, 0, 0.1})});
  const TextureLease lease = latest_.acquire();
  PredictedView whole = view_through(small_lens(GetParam())), banded = view_through(small_lens(GetParam()));
  MonotonicClock clock;
  FrameGate gate(clock);
  banded.use(&gate);
  whole.draw(usual_view(), state_of(*scene_), *lease);
  banded.draw(usual_view(), state_of(*scene_),
              *lease);  // what bands cost is not known yet: they are as large as it goes
  EXPECT_GT(gate.slices(), 0u);
  banded.draw(usual_view(), state_of(*scene_), *lease);
  EXPECT_EQ(cv::norm(whole.read(), banded.read(), cv::NORM_INF), 0);
}

TEST_P(ViewOfLenses, ShowsThePhotographAgain) {
  const Lens lens = small_lens(GetParam());
  extract({usual_view()}, GetParam());
  PredictedView view = view_through(lens);
  const TextureLease lease = latest_.acquire();
  view.draw(usual_view(), state_of(*scene_), *lease);
  const cv::Mat picture = view.read(), photo = photograph(*scene_, state_of(*scene_), lens, usual_view());
  double sum = 0;
  int seen = 0, model = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec4b got = picture.at<cv::Vec4b>(y, x);
      model += got[3] != 0;
      if (got[3] != 255) continue;
      ++seen;
      for (int c = 0; c < 3; ++c) sum += std::abs(got[c] - photo.at<cv::Vec3b>(y, x)[c]) / 3.0;
    }
  // Uncertain edges and the frame are lost; what is shown has been filtered twice.
  EXPECT_GT(seen, 0.7 * model);
  EXPECT_LT(sum / seen, 3);
}

TEST_F(PredictedViewTest, TellsSeenFilledBareAndEmptyApart) {
  extract({usual_view()});
  PredictedView view = view_through(small_lens("pinhole"));
  const TextureLease lease = latest_.acquire();
  const auto count = [&](const Pose& T_world_camera) {
    view.draw(T_world_camera, state_of(*scene_), *lease);
    std::map<int, int> states;
    const cv::Mat picture = view.read();
    for (int i = 0; i < static_cast<int>(picture.total()); ++i) ++states[picture.ptr<cv::Vec4b>()[i][3]];
    return states;
  };
  auto front = count(usual_view());
  EXPECT_GT(front[255], 6000);
  EXPECT_GT(front[128], 100) << "what was hidden is filled";
  auto behind = count(look_at({1.3, 0.5, 0.5}, {0.3, 0.1, 0.2}));
  EXPECT_GT(behind[128], 500);
  auto away = count(look_at({0, 0, 1}, {0.1, 0, 2}));
  EXPECT_EQ(away[0], 160 * 120);
}

TEST_F(PredictedViewTest, ModelWithoutAnyTextureIsBare) {
  // A camera that looks away: nothing was ever seen.
  extract({look_at({0, 0, 1}, {0.1, 0, 2})});
  PredictedView view = view_through(small_lens("pinhole"));
  const TextureLease lease = latest_.acquire();
  view.draw(usual_view(), state_of(*scene_), *lease);
  const cv::Mat picture = view.read();
  int bare = 0;
  for (int i = 0; i < static_cast<int>(picture.total()); ++i) {
    const cv::Vec4b got = picture.ptr<cv::Vec4b>()[i];
    ASSERT_TRUE(got[3] == 64 || got[3] == 0) << "pixel " << i;
    ASSERT_EQ(got[0] + got[1] + got[2], 0);
    bare += got[3] == 64;
  }
  EXPECT_GT(bare, 5000);
}

// Sentinels: a texture of the same kind beside the picture, and the atlas itself.
TEST_F(PredictedViewTest, MatchesTheGoldenView) {
  extract({usual_view()});
  PredictedView view = view_through(small_lens("plumb_bob"));
  const gl::Texture beside(GL_RGBA8, 160, 120, 0, 1, "beside");
  const std::uint8_t sentinel[4] = {9, 8, 7, 6};
  glClearTexImage(beside.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, sentinel);
  const gl::Texture& atlas = *latest_.acquire()->colours;
  const reference::AtlasPixels before(atlas);
  const TextureLease lease = latest_.acquire();
  view.draw(look_at({-0.75, -0.75, 0.6}, {0.05, 0, 0.1}), state_of(*scene_, 0.1), *lease);
  const cv::Mat picture = view.read();
  std::vector<std::array<std::uint8_t, 4>> untouched(160 * 120);
  glGetTextureImage(beside.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(untouched.size() * 4),
                    untouched.data());
  for (const auto& v : untouched) ASSERT_EQ(v, (std::array<std::uint8_t, 4>{9, 8, 7, 6}));
  EXPECT_EQ(reference::AtlasPixels(atlas).levels[0], before.levels[0]) << "looking changes nothing";
  // Rounding of colours and alpha; silhouettes that fall on the other side of a pixel's centre.
  EXPECT_TRUE(matches_golden(picture, "view", {0.5, 6, 0.01}));
}

}  // namespace
}  // namespace foresight::predicted_view_test
