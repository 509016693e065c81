// Pixels are said to be exact only where an image of late has seen what they show.
#include "display/trust_pass.hpp"

#include <opencv2/imgproc.hpp>

#include "display/picture_readback.hpp"
#include "display/view_modes.hpp"
#include "pictures/view_alpha.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::trust_pass_test {
namespace {

using namespace std::chrono_literals;

/// Where the block stands at rest (its middle on the table), beside the box, and a corner of the table.
const Eigen::Vector3d kUnderBlock(-0.2, -0.25, 0), kOnBlock(-0.2, -0.25, 0.1), kOnTable(-0.5, 0.3, 0);
constexpr double kMove = 0.3;  // m, of the block: clear of where it stood

class TrustPassTest : public HeadlessTest, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    lens_ = small_lens(GetParam());
    core_ = std::make_unique<TextureCore>(scene_, surface_, lens_, std::nullopt,
                                          TextureOptions{.memory_bytes = 6 << 20}, driver_.is_software);
    const auto buffers = std::make_shared<gl::SceneBuffers>(*scene_);
    const auto records = std::make_shared<SurfaceRecords>(*surface_);
    view_ = std::make_unique<PredictedView>(buffers, records, lens_);
    trust_ = std::make_unique<TrustPass>(buffers, records, lens_, *view_);
  }
  PosedImage image(double block_x, Duration when) {
    PosedImage out = posed_photograph(*scene_, state_of(*scene_, block_x), lens_, usual_view());
    out.time = RobotTime{} + when;
    return out;
  }
  void see(double block_x, Duration when) {
    const PosedImage seen = image(block_x, when);
    core_->process({seen, std::nullopt}, latest_);
    trust_->saw(seen);
  }
  /// The view with the block there, and its doubt.
  RememberedView draw(double block_x, const std::vector<double>& px = {}, const ExactKinds& exact = {}) {
    const TextureLease lease = latest_.acquire();
    const SceneState state = state_of(*scene_, block_x);
    view_->draw(usual_view(), state, *lease);
    return judge(state, px, exact);
  }
  /// The view that was drawn last, and its doubt.
  RememberedView judge(const SceneState& state, const std::vector<double>& px, const ExactKinds& exact) {
    (*trust_)(*view_, usual_view(), state, px, exact);
    PictureReadback readback;
    EXPECT_TRUE(readback.start(view_->picture(), trust_->doubt(), RobotTime{1}));
    auto out = readback.take(true);
    EXPECT_TRUE(out);
    EXPECT_FALSE(readback.take(true));
    return std::move(*out);
  }
  cv::Point pixel_of(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector2d pixel = lens_.project(usual_view().inverse() * p_world).value();
    return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
  }
  /// In the view as large as it is now.
  cv::Point small_pixel_of(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector2d pixel = view_->lens().project(usual_view().inverse() * p_world).value();
    return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
  }
  static int at(const cv::Mat& doubt, cv::Point pixel) { return doubt.at<uchar>(pixel); }
  cv::Mat marked() const {
    cv::Mat out(lens_.height(), lens_.width(), CV_8UC4);
    glGetTextureImage(trust_->marked().name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4),
                      out.data);
    return out;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  Lens lens_;
  LatestTextures latest_;
  std::unique_ptr<TextureCore> core_;
  std::unique_ptr<PredictedView> view_;
  std::unique_ptr<TrustPass> trust_;
};

TEST_P(TrustPassTest, OnlyWhatWasSeenIsConfirmed) {
  core_->process({image(0, 100ms), std::nullopt}, latest_);  // that the pass was not told of
  const RememberedView before = draw(0);
  EXPECT_EQ(cv::countNonZero(before.doubt != kUnconfirmed), 0);
  trust_->saw(image(0, 200ms));
  const RememberedView after = draw(0);
  cv::Mat alpha;
  cv::extractChannel(after.picture, alpha, 3);
  const cv::Mat seen = alpha == 255;
  EXPECT_GT(cv::countNonZero(seen), 1500);
  EXPECT_GT(cv::countNonZero((after.doubt < kUnconfirmed) & seen), 0.95 * cv::countNonZero(seen));
  EXPECT_EQ(cv::countNonZero((after.doubt < kUnconfirmed) & ~seen), 0) << "what is filled is not exact";
}

// What lies beside an edge of the newest image, and nothing else has seen.
TEST_P(TrustPassTest, WhatMayShowAnotherSurfaceIsAKindOfItsOwn) {
  const PosedImage seen = image(0, 100ms);
  LatestImages images;
  core_->process({seen, std::nullopt}, latest_);
  ASSERT_TRUE(core_->look({seen, std::nullopt}, images));
  trust_->saw(seen);
  ExactKinds others;
  for (std::size_t kind = 0; kind < kBesideEdge; ++kind) others.set(kind);
  view_->draw(usual_view(), state_of(*scene_), latest_.acquire(), images.acquire());
  const RememberedView view = judge(state_of(*scene_), {}, others);
  const cv::Mat hatched = marked();
  int uncertain = 0, striped = 0;
  for (int y = 0; y < hatched.rows; ++y)
    for (int x = 0; x < hatched.cols; ++x) {
      if (hatched.at<cv::Vec4b>(y, x)[3] != view_alpha::kFromEdge) continue;
      ++uncertain;
      const int doubt = view.doubt.at<uchar>(y, x);
      EXPECT_TRUE(doubt >= kBesideEdge && doubt < kKindsEnd) << x << ' ' << y << ": " << doubt;
      const auto shown = view.picture.at<cv::Vec4b>(y, x), marked = hatched.at<cv::Vec4b>(y, x);
      EXPECT_EQ(shown[3], 255) << "an image shows it";
      striped += shown[0] != marked[0] || shown[1] != marked[1] || shown[2] != marked[2];
    }
  EXPECT_GT(uncertain, 30);
  EXPECT_NEAR(striped / static_cast<double>(uncertain), 1.0 / 3, 0.15);
}

// The newest image that saw a point tells what coding took away there.
TEST_P(TrustPassTest, WhatCodingTookAwayIsAKindOfItsOwn) {
  see(0, 100ms);
  PosedImage newest = image(0, 200ms);
  newest.lost = cv::Mat::zeros(kLossRows, kLossColumns, CV_8UC1);
  const cv::Point there = pixel_of(kOnTable),
                  tile(there.x * kLossColumns / lens_.width(), there.y * kLossRows / lens_.height());
  newest.lost.at<uchar>(tile) = 3;
  trust_->saw(newest);
  const RememberedView view = draw(0);
  cv::Mat grey;
  cv::cvtColor(view.picture, grey, cv::COLOR_BGRA2GRAY);
  const cv::Mat contrast = contrast_steps(grey);
  std::set<int> contrasts;
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      const int doubt = view.doubt.at<uchar>(y, x);
      if (doubt < kCodedAway || doubt >= kBesideEdge) continue;
      const int of = (doubt - kCodedAway) % kLossContrasts;
      ASSERT_EQ(doubt, coded_away(3, of));
      ASSERT_NEAR(of, loss_contrast(contrast.at<uchar>(y, x)), 1) << "levels are rounded on the way";
      contrasts.insert(of);
    }
  EXPECT_GE(contrasts.size(), 2u);
  const cv::Mat lossy = (view.doubt >= kCodedAway) & (view.doubt < kBesideEdge);
  const double area = static_cast<double>(lossy.total()) / (kLossRows * kLossColumns);
  EXPECT_GT(cv::countNonZero(lossy), 0.3 * area);
  EXPECT_LT(cv::countNonZero(lossy), 1.5 * area) << "other tiles have lost nothing";
  newest.time = newest.time + 50ms;
  newest.lost.at<uchar>(tile) = kToldSteps + 1;
  trust_->saw(newest);
  EXPECT_EQ(at(draw(0).doubt, there), kMostlyCodedAway);
  see(0, 300ms);
  EXPECT_EQ(cv::countNonZero((draw(0).doubt >= kCodedAway) & (draw(0).doubt < kBesideEdge)), 0) << "it was seen anew";
}

// A view with fewer pixels than the images says of each place what the large one says.
TEST_P(TrustPassTest, ViewsMayHaveAnotherNumberOfPixels) {
  see(kMove, 100ms);
  see(0, 200ms);
  const RememberedView whole = draw(kMove);
  view_->set_lens(scaled_lens(lens_, 0.6));
  RememberedView small = draw(kMove);
  ASSERT_EQ(small.doubt.cols, view_->lens().width());
  ASSERT_EQ(small.doubt.rows, view_->lens().height());
  cv::resize(small.doubt, small.doubt, whole.doubt.size(), 0, 0, cv::INTER_NEAREST);
  const cv::Mat confirmed = whole.doubt < kUnconfirmed;
  EXPECT_LT(cv::countNonZero(confirmed != (small.doubt < kUnconfirmed)), 0.05 * static_cast<double>(confirmed.total()))
      << "edges alone differ";
  EXPECT_EQ(at(small.doubt, pixel_of(kUnderBlock)), kUnconfirmed);
  EXPECT_LT(at(small.doubt, pixel_of(kOnTable)), kUnconfirmed);
  // What was compared with an image is found again, too.
  const PosedImage compared = image(kMove, 300ms);
  trust_->compared(compared, cv::Mat(lens_.height(), lens_.width(), CV_8UC1, cv::Scalar(2)));
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, small_pixel_of(kOnTable))).compared, Compared::alike);
}

TEST_P(TrustPassTest, WhatAPartLeavesBehindIsNotConfirmedUntilItIsSeenAgain) {
  see(kMove, 100ms);  // the table where the block will be is seen
  see(0, 200ms);
  const RememberedView moved = draw(kMove);
  EXPECT_EQ(at(moved.doubt, pixel_of(kUnderBlock)), kUnconfirmed) << "it covered this in the newest image";
  EXPECT_LT(at(moved.doubt, pixel_of(kOnTable)), kUnconfirmed);
  EXPECT_LT(at(moved.doubt, pixel_of(kOnBlock + Eigen::Vector3d(kMove, 0, 0))), kUnconfirmed)
      << "the block takes its picture along";
  see(kMove, 300ms);
  EXPECT_LT(at(draw(kMove).doubt, pixel_of(kUnderBlock)), kUnconfirmed);
}

TEST_P(TrustPassTest, DoubtTellsHowFarOffAPartMayBe) {
  see(0, 100ms);
  const cv::Point middle = pixel_of(kOnBlock);
  const auto on_block = [&](double px) {
    std::vector<double> all(scene_->nodes().size(), 0);
    all[kBlock] = px;
    return kind_of(at(draw(0, all).doubt, middle));
  };
  const DoubtKind still = on_block(0);
  EXPECT_EQ(still.reach, 0);
  EXPECT_EQ(still.compared, Compared::never);
  for (const auto& [px, reach] : {std::pair{0.4, 0}, {1.9, 0}, {2.2, 1}, {30.0, 1}}) {
    const DoubtKind kind = on_block(px);
    EXPECT_EQ(kind.contrast, still.contrast);
    EXPECT_EQ(kind.reach, reach) << px;
  }
  std::vector<double> anywhere(scene_->nodes().size(), 0);
  anywhere[kBlock] = kAnywherePx;
  EXPECT_EQ(at(draw(0, anywhere).doubt, middle), kUnconfirmed);
}

TEST_P(TrustPassTest, DoubtTellsContrast) {
  see(0, 100ms);
  const RememberedView view = draw(0);
  cv::Mat grey;
  cv::cvtColor(view.picture, grey, cv::COLOR_BGRA2GRAY);
  int compared = 0;
  for (int y = 1; y + 1 < grey.rows; ++y)
    for (int x = 1; x + 1 < grey.cols; ++x) {
      if (view.doubt.at<uchar>(y, x) == kUnconfirmed) continue;
      cv::Mat around;
      grey(cv::Rect(x - 1, y - 1, 3, 3)).convertTo(around, CV_64F);
      const double levels = std::sqrt(cv::norm(around - around.at<double>(1, 1), cv::NORM_L2SQR) / 8);
      const DoubtKind kind = kind_of(view.doubt.at<uchar>(y, x));
      const double low = 3 * (std::exp2(kind.contrast / 4.0) - 1),
                   high = 3 * (std::exp2((kind.contrast + 1) / 4.0) - 1);
      ASSERT_GE(levels, low - 1.1) << x << ' ' << y;
      ASSERT_TRUE(levels <= high + 1.1 || kind.contrast + 1 == DoubtKind::kContrasts) << x << ' ' << y;
      ++compared;
    }
  EXPECT_GT(compared, 1000);
}

// What comparisons said goes with the surface: the block has moved since, and what was said of it with it.
TEST_P(TrustPassTest, WhatWasComparedIsRememberedOfTheSurface) {
  see(kMove, 100ms);
  see(0, 200ms);
  cv::Mat comparison(lens_.height(), lens_.width(), CV_8UC1, cv::Scalar(kNotShown));
  const cv::Point on_table = pixel_of(kOnTable), on_block = pixel_of(kOnBlock),
                  moved = pixel_of(kOnBlock + Eigen::Vector3d(kMove, 0, 0));
  Duration when = 200ms;
  const auto compare = [&](int said) {
    cv::circle(comparison, on_block, 3, said, -1);
    trust_->compared(image(0, when += 10ms), comparison);
  };
  const auto said_of_block = [&](int said) {
    for (std::size_t i = 0; i < kComparisonsKept; ++i) compare(said);
    return kind_of(at(draw(kMove).doubt, moved)).compared;
  };
  cv::circle(comparison, on_table, 3, kInPatch, -1);
  EXPECT_EQ(said_of_block(1), Compared::same);
  EXPECT_EQ(said_of_block(2), Compared::alike);
  EXPECT_EQ(said_of_block(4), Compared::close);
  EXPECT_EQ(said_of_block(6), Compared::near);
  EXPECT_EQ(said_of_block(40), Compared::off);
  EXPECT_EQ(said_of_block(kInPatch), Compared::suspect);
  EXPECT_EQ(said_of_block(kNotShown), Compared::never);
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, on_table)).compared, Compared::suspect);
  compare(5);
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, moved)).compared, Compared::near) << "once is enough where it is all";
  compare(1);
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, moved)).compared, Compared::close) << "the mean of both";
  for (std::size_t i = 1; i < kComparisonsKept; ++i) compare(1);
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, moved)).compared, Compared::same) << "the older one is forgotten";
  trust_->forget_patches();
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, on_table)).compared, Compared::never) << "their reason is no more";
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, moved)).compared, Compared::same) << "it lies in none";
  compare(1);
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, on_table)).compared, Compared::suspect) << "a new one";
  trust_->compared(image(0, 50ms), comparison);
  EXPECT_EQ(kind_of(at(draw(kMove).doubt, moved)).compared, Compared::same) << "by another clock";
  EXPECT_TRUE(std::ranges::equal(kLevelsOff, std::array{1.5, 2.5, 4.5, 6.5})) << "as trust.comp has them";
}

TEST_P(TrustPassTest, WhatIsNotExactIsHatched) {
  see(kMove, 100ms);
  see(0, 200ms);
  ExactKinds kinds;
  for (int i = 0; i < DoubtKind::kCount; ++i) kinds[static_cast<std::size_t>(i)] = kind_of(i).contrast < 8;
  const RememberedView view = draw(kMove, {}, kinds);
  const cv::Mat shown = marked();
  int exact = 0, others = 0, striped = 0;
  for (int y = 0; y < shown.rows; ++y)
    for (int x = 0; x < shown.cols; ++x) {
      const auto before = view.picture.at<cv::Vec4b>(y, x), after = shown.at<cv::Vec4b>(y, x);
      if (before[3] < 128) continue;
      if (kinds[view.doubt.at<uchar>(y, x)]) {
        ++exact;
        ASSERT_EQ(before, after) << x << ' ' << y;
      } else {
        ++others;
        striped += cv::norm(before, after) > 40 ? 1 : 0;
      }
    }
  EXPECT_GT(exact, 500);
  EXPECT_GT(others, 100);
  EXPECT_NEAR(striped / static_cast<double>(others), 1.0 / 3, 0.1) << "so that the picture shows between the stripes";
}

INSTANTIATE_TEST_SUITE_P(Lenses, TrustPassTest, testing::Values("pinhole", "rational", "wide_fisheye"),
                         [](const auto& lens) { return std::string(lens.param); });

}  // namespace
}  // namespace foresight::trust_pass_test
