// Views that tell more than colours: painted ones, and the operator's view as seen from beside.
#include "display/observer_pass.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "display/uploaded_picture.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::observed_view_test {
namespace {

using namespace std::chrono_literals;

class ObservedViewTest : public HeadlessTest {
 protected:
  void extract(const Pose& from, RobotTime time) {
    if (!core_)
      core_ = std::make_unique<TextureCore>(scene_, surface_, lens_, std::nullopt,
                                            TextureOptions{.memory_bytes = 6 << 20}, driver_.is_software);
    PosedImage image = posed_photograph(*scene_, state_of(*scene_), lens_, from);
    image.time = time;
    core_->process({image, std::nullopt}, latest_);
  }
  PredictedView view(const Lens& lens) const {
    return {std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens};
  }
  cv::Mat painted(ViewPaint paint, const Pose& from, RobotTime instant = {}) {
    PredictedView drawn = view(lens_);
    drawn.set_paint(paint);
    const TextureLease lease = latest_.acquire();
    SceneState state = state_of(*scene_);
    state.time = instant;
    drawn.draw(from, state, *lease);
    return drawn.read();
  }
  static void keep(const char* name, const cv::Mat& picture) {
    if (const char* folder = std::getenv("FORESIGHT_PICTURES"))
      cv::imwrite(std::string(folder) + "/" + name + ".png", picture);
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  Lens lens_ = small_lens("plumb_bob");
  LatestTextures latest_;
  std::unique_ptr<TextureCore> core_;
};

// Blue: seen just now; yellow: seconds ago; red: long ago; violet: never.
double share(const cv::Mat& picture, const cv::Scalar& from, const cv::Scalar& to, const cv::Mat& mask) {
  cv::Mat hsv, in;
  cv::cvtColor(picture, hsv, cv::COLOR_BGR2HSV);
  cv::inRange(hsv, from, to, in);
  cv::bitwise_and(in, mask, in);
  return cv::countNonZero(in) / std::max(1.0, static_cast<double>(cv::countNonZero(mask)));
}
cv::Mat model_of(const cv::Mat& picture) {
  cv::Mat alpha;
  cv::extractChannel(picture, alpha, 3);
  return alpha > 0;
}
const cv::Scalar kFreshFrom(90, 60, 0), kFreshTo(115, 255, 255), kNeverFrom(135, 60, 0), kNeverTo(165, 255, 255),
    kSecondsFrom(20, 60, 0), kSecondsTo(32, 255, 255), kOldFrom(5, 120, 0), kOldTo(14, 255, 255);

TEST_F(ObservedViewTest, AgesAreThoseOfTheImagesThatSaw) {
  extract(usual_view(), RobotTime{} + 1s);
  const cv::Mat fresh = painted(ViewPaint::age, usual_view());
  keep("age_fresh", fresh);
  EXPECT_GT(share(fresh, kFreshFrom, kFreshTo, model_of(fresh)), 0.75);
  extract(look_at({0, 0, 1}, {0.1, 0, 2}), RobotTime{} + 20s);  // looks away: nothing is seen again
  const cv::Mat old = painted(ViewPaint::age, usual_view());
  keep("age_old", old);
  EXPECT_LT(share(old, kFreshFrom, kFreshTo, model_of(old)), 0.02);
  EXPECT_GT(share(old, kOldFrom, kOldTo, model_of(old)), 0.75);
  const cv::Mat behind = painted(ViewPaint::age, look_at({1.3, 0.5, 0.5}, {0.3, 0.1, 0.2}));
  keep("age_behind", behind);
  EXPECT_GT(share(behind, kNeverFrom, kNeverTo, model_of(behind)), 0.2) << "what no image saw";
}

// Over a line of a second each way nothing is less than a second old; where images end, all grows older.
TEST_F(ObservedViewTest, AgesGoOnToTheInstantShown) {
  extract(usual_view(), RobotTime{} + 1s);
  const auto seen = [&](Duration after, const cv::Scalar& from, const cv::Scalar& to) {
    const cv::Mat picture = painted(ViewPaint::age, usual_view(), RobotTime{} + 1s + after);
    return share(picture, from, to, model_of(picture));
  };
  EXPECT_GT(seen(900ms, kFreshFrom, kFreshTo), 0.75);
  EXPECT_EQ(seen(1100ms, kFreshFrom, kFreshTo), 0);
  EXPECT_GT(seen(1100ms, kSecondsFrom, kSecondsTo), 0.75);
  EXPECT_GT(seen(4900ms, kSecondsFrom, kSecondsTo), 0.75);
  EXPECT_EQ(seen(5100ms, kSecondsFrom, kSecondsTo), 0);
  EXPECT_GT(seen(5100ms, kOldFrom, kOldTo), 0.75);
}

TEST_F(ObservedViewTest, ConfidenceFallsWhereTheViewIsFiner) {
  extract(look_at({-1.8, -1.8, 1.4}, {0, 0, 0.1}), RobotTime{} + 1s);
  const cv::Mat far = painted(ViewPaint::confidence, look_at({-1.8, -1.8, 1.4}, {0, 0, 0.1})),
                near = painted(ViewPaint::confidence, look_at({-0.4, -0.4, 0.3}, {0.05, 0.1, 0.1}));
  keep("confidence_far", far);
  keep("confidence_near", near);
  EXPECT_GT(share(far, kFreshFrom, kFreshTo, model_of(far)), 0.5);
  EXPECT_LT(share(near, kFreshFrom, kFreshTo, model_of(near)), 0.2);
}

TEST_F(ObservedViewTest, AWireframeIsThinAndEverywhere) {
  extract(usual_view(), RobotTime{} + 1s);
  const cv::Mat picture = painted(ViewPaint::wireframe, usual_view());
  keep("wireframe", picture);
  cv::Mat green;
  cv::inRange(picture, cv::Scalar(150, 250, 120, 0), cv::Scalar(180, 255, 150, 255), green);
  EXPECT_GT(cv::countNonZero(green), 200);
  EXPECT_LT(cv::countNonZero(green), 0.15 * static_cast<double>(green.total()));
}

// From where the operator is, all is lit but what his picture leaves out; from behind him, what he cannot see is dark.
TEST_F(ObservedViewTest, TheOperatorsViewIsASpotlight) {
  extract(usual_view(), RobotTime{} + 1s);
  const TextureLease lease = latest_.acquire();
  PredictedView operators = view(lens_), beside = view(observer_lens(200, 150, 1.4)),
                plain = view(observer_lens(200, 150, 1.4));
  ObserverPass pass;
  operators.draw(usual_view(), state_of(*scene_), *lease);
  cv::Mat model;
  const auto brightness = [&](const Pose& from, bool lit) {
    PredictedView& v = lit ? beside : plain;
    v.draw(from, state_of(*scene_), *lease);
    if (lit)
      pass(v, from, operators, usual_view(), {});
    else
      model = model_of(v.read());
    cv::Mat grey;
    cv::cvtColor(v.read(), grey, cv::COLOR_BGRA2GRAY);
    return grey;
  };
  const auto dark_share = [&](const Pose& from) {
    const cv::Mat before = brightness(from, false), after = brightness(from, true);
    int dark = 0;
    for (int i = 0; i < static_cast<int>(model.total()); ++i)
      dark += model.data[i] && before.data[i] > 20 && after.data[i] < 0.6 * before.data[i];
    return dark / static_cast<double>(cv::countNonZero(model));
  };
  EXPECT_LT(dark_share(usual_view()), 0.25) << "only what lies beside his picture";
  EXPECT_GT(dark_share(look_at({0.6, -0.7, 0.4}, {0, 0.1, 0.1})), 0.08) << "sides that he does not see";
  const cv::Rect middle(70, 50, 60, 50);
  const cv::Mat before = brightness(usual_view(), false), lit = brightness(usual_view(), true);
  EXPECT_GT(cv::mean(lit(middle))[0], 0.95 * cv::mean(before(middle))[0]);
}

TEST_F(ObservedViewTest, ThePanelStandsBeforeItsCamera) {
  extract(usual_view(), RobotTime{} + 1s);
  const TextureLease lease = latest_.acquire();
  UploadedPicture image("image");
  image.upload(cv::Mat(120, 160, CV_8UC3, cv::Scalar(255, 0, 255)));
  const std::vector<CameraPanel> panels{{lens_, usual_view(), &image.texture()}};
  PredictedView operators = view(lens_), beside = view(observer_lens(320, 240, 1.4));
  const Pose from = look_at({-0.3, -2.2, 1.3}, {-0.3, -0.3, 0.3});
  operators.draw(usual_view(), state_of(*scene_), *lease);
  beside.draw(from, state_of(*scene_), *lease);
  ObserverPass pass;
  pass(beside, from, operators, usual_view(), panels);
  const cv::Mat picture = beside.read();
  keep("observer", picture);
  cv::Mat pink;
  cv::inRange(picture, cv::Scalar(240, 0, 240, 0), cv::Scalar(255, 30, 255, 255), pink);
  ASSERT_GT(cv::countNonZero(pink), 100);
  // Its middle is where the camera's axis meets it, 0.3 m before the camera.
  const cv::Moments m = cv::moments(pink, true);
  const Eigen::Vector3d p = from.inverse() * (usual_view() * Eigen::Vector3d(0, 0, 0.3));
  const Eigen::Vector2d expected = *beside.lens().project(p);
  EXPECT_NEAR(m.m10 / m.m00, expected.x(), 8);
  EXPECT_NEAR(m.m01 / m.m00, expected.y(), 8);
}

TEST_F(ObservedViewTest, AViewOfAnotherSizeIsTheSamePicture) {
  extract(usual_view(), RobotTime{} + 1s);
  const TextureLease lease = latest_.acquire();
  PredictedView drawn = view(lens_);
  drawn.draw(usual_view(), state_of(*scene_), *lease);
  const cv::Mat small = drawn.read();
  drawn.set_lens(fitted_lens(lens_, 480, 360));
  drawn.draw(usual_view(), state_of(*scene_), *lease);
  cv::Mat large = drawn.read();
  ASSERT_EQ(large.size(), cv::Size(480, 360));
  cv::resize(large, large, small.size(), 0, 0, cv::INTER_AREA);
  cv::Mat difference;
  cv::absdiff(small, large, difference);
  EXPECT_LT(cv::mean(difference)[0], 4);
}

}  // namespace
}  // namespace foresight::observed_view_test
