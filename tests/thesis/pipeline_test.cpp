// The whole pipeline of the thesis on the small scene, seen from a new pose.
#include "texture_gpu/thesis/thesis_pipeline.hpp"

#include "common/error.hpp"
#include "display/thesis_view.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::pipeline_test {
namespace {

/// Predicted view against the true one, over pixels with colours that cameras saw.
struct Quality {
  double psnr = 0;
  double covered = 0;  // share of the pixels that show the model
};

class ThesisPipeline : public HeadlessTest {
 protected:
  Quality quality(const Lens& lens, const thesis::Options& options, const Pose& T_new) {
    thesis::Pipeline pipeline(scene_, lens, std::nullopt, options, driver_.is_software);
    for (const Pose& T : {look_at({-0.9, -0.6, 0.75}, {0.02, 0, 0.1}), usual_view()}) {
      const ExtractionReport report =
          pipeline.process({posed_photograph(*scene_, state_of(*scene_), lens, T), std::nullopt});
      EXPECT_TRUE(report.published);
      EXPECT_GT(report.pages, 5u);
    }
    ThesisView view(pipeline, lens);
    view.draw(T_new, state_of(*scene_, 0.04));  // the block has moved on: its texture moves with it
    const cv::Mat got = view.read(), truth = photograph(*scene_, state_of(*scene_, 0.04), lens, T_new);
    double sum = 0;
    int seen = 0, model = 0;
    for (int y = 0; y < truth.rows; ++y)
      for (int x = 0; x < truth.cols; ++x) {
        const cv::Vec3b& t = truth.at<cv::Vec3b>(y, x);
        const cv::Vec4b& g = got.at<cv::Vec4b>(y, x);
        model += t != cv::Vec3b();
        if (g[3] != 255 || t == cv::Vec3b()) continue;
        ++seen;
        for (int c = 0; c < 3; ++c) sum += (g[c] - t[c]) * (g[c] - t[c]) / 3.0;
      }
    EXPECT_GT(model, 5000);
    return {10 * std::log10(255.0 * 255.0 * seen / sum), static_cast<double>(seen) / model};
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  const Pose new_pose_ = look_at({-0.95, -0.35, 0.85}, {0.02, 0.02, 0.1});
};

// With one pixel wrong at each silhouette the view of this scene has 28 dB; with textures upside
// down or off by some texels less than 20.
TEST_F(ThesisPipeline, ShowsTheSceneFromANewPose) {
  for (const char* kind : {"pinhole", "plumb_bob"}) {
    const Quality q = quality(small_lens(kind), {}, new_pose_);
    EXPECT_GT(q.psnr, 27) << kind;
    EXPECT_GT(q.covered, 0.8) << kind;
  }
}

TEST_F(ThesisPipeline, OcclusionAndExpansionKeepForeignColoursAway) {
  const Lens lens = small_lens("pinhole");
  const Quality all = quality(lens, {}, new_pose_), none = quality(lens, {.occlusion = false}, new_pose_);
  EXPECT_GT(all.psnr, none.psnr + 3) << "figure 4.4";
}

TEST_F(ThesisPipeline, HolesAreFilledInEveryWay) {
  const Lens lens = small_lens("pinhole");
  for (const auto way : {thesis::HoleFilling::pyramid, thesis::HoleFilling::shader_one_stage,
                         thesis::HoleFilling::shader, thesis::HoleFilling::shader_query}) {
    thesis::Pipeline pipeline(scene_, lens, std::nullopt, {.hole_filling = way}, driver_.is_software);
    pipeline.process({posed_photograph(*scene_, state_of(*scene_), lens, usual_view()), std::nullopt});
    // Behind the box: what it hid is filled with the table's green, not black.
    ThesisView view(pipeline, lens);
    view.draw(look_at({1.0, 0.5, 0.9}, {0.1, 0.1, 0}), state_of(*scene_));
    const cv::Mat got = view.read();
    int filled = 0, dark = 0;
    for (int y = 0; y < got.rows; ++y)
      for (int x = 0; x < got.cols; ++x) {
        const cv::Vec4b& g = got.at<cv::Vec4b>(y, x);
        if (g[3] != 128) continue;
        ++filled;
        dark += g[1] < 40;
      }
    EXPECT_GT(filled, 300);
    EXPECT_LT(dark, filled / 10);
  }
}

TEST_F(ThesisPipeline, TheMaskShowsWhatIsHidden) {
  const Lens lens = small_lens("pinhole");
  thesis::Pipeline pipeline(scene_, lens, std::nullopt, {}, driver_.is_software);
  const PosedImage image = posed_photograph(*scene_, state_of(*scene_), lens, usual_view());
  std::size_t table = 0;
  while (pipeline.textures().polygons()[table].node != kTable) ++table;
  const cv::Mat plain = pipeline.alpha_mask(image, table, thesis::Expansion::none, 0);
  const cv::Mat grown = pipeline.alpha_mask(image, table, thesis::Expansion::shader, 3);
  ASSERT_EQ(plain.size(), grown.size());
  const int hidden = cv::countNonZero(plain == 0);
  EXPECT_GT(hidden, 500) << "by the box and the block";
  EXPECT_GT(cv::countNonZero(grown == 0), hidden + 200);
  EXPECT_EQ(cv::countNonZero((plain == 0) & (grown != 0)), 0);
}

TEST_F(ThesisPipeline, RefusesLensesThatFitNoPlane) {
  EXPECT_THROW(thesis::Pipeline(scene_, small_lens("wide_fisheye"), std::nullopt, {}, driver_.is_software), InputError);
}

}  // namespace
}  // namespace foresight::pipeline_test
