// Whether a stereogram tells the depth that it was made from, to a decoder that knows nothing of how it was made.
#include "display/stereogram/stereogram.hpp"

#include <array>
#include <opencv2/imgproc.hpp>
#include <set>

#include "display/stereogram/decode.hpp"
#include "display/stereogram/live_stereogram.hpp"
#include "gl/raster_pass.hpp"
#include "gl/read_texture.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::stereogram_test {
namespace {

constexpr int kWidth = 480, kHeight = 120;

TEST(StereogramDepth, SeparationsAreThoseOfTheFormula) {
  const StereogramDepth depth{200, 1 / 3., false};
  EXPECT_NEAR(depth.separation(0), 100, 1e-9);
  EXPECT_NEAR(depth.separation(1), 80, 1e-9);
  EXPECT_NEAR(depth.separation(0.5), 200 * (5 / 6.) / (11 / 6.), 1e-9);
  const StereogramDepth inverted{200, 1 / 3., true};
  EXPECT_NEAR(inverted.separation(1), 100, 1e-9);
  EXPECT_EQ(inverted.least(), depth.least());
  EXPECT_EQ(inverted.most(), depth.most());
}

TEST(StereogramDepth, ItsRangeIsThatOfWhatIsThere) {
  cv::Mat inverse(10, 100, CV_32F, cv::Scalar(0));
  EXPECT_EQ(depth_range(inverse).far, 0);
  inverse.colRange(10, 50) = 0.5;
  inverse.colRange(50, 90) = 2;
  const DepthRange range = depth_range(inverse);
  EXPECT_NEAR(range.near, 0.5, 1e-6);
  EXPECT_NEAR(range.far, 2, 1e-6);
  const cv::Mat z = nearness(inverse, range);
  EXPECT_EQ(z.at<float>(0, 5), 0);
  EXPECT_EQ(z.at<float>(0, 20), 0);
  EXPECT_EQ(z.at<float>(0, 60), 1);
  const DepthRange flat = depth_range(cv::Mat(4, 4, CV_32F, cv::Scalar(0.5)));
  EXPECT_LT(flat.near, flat.far);
}

class StereogramTest : public HeadlessTest {
 protected:
  /// Of inverse distances, as gl::FaceImages has it.
  static gl::Texture depth_of(const cv::Mat& inverse) {
    gl::Texture out(GL_DEPTH_COMPONENT32F, inverse.cols, inverse.rows, 1, 1, "depth");
    const cv::Mat depth = inverse * gl::kNearPlane;
    glTextureSubImage3D(out.name(), 0, 0, 0, 0, inverse.cols, inverse.rows, 1, GL_DEPTH_COMPONENT, GL_FLOAT,
                        depth.data);
    return out;
  }
  /// A ramp with a block before it and a hole in it: from 1 to 2 m.
  static cv::Mat shapes() {
    cv::Mat inverse(kHeight, kWidth, CV_32F);
    for (int x = 0; x < kWidth; ++x) inverse.col(x) = 0.5 + 0.25 * x / kWidth;
    inverse(cv::Rect(160, 30, 90, 60)) = 1;
    inverse(cv::Rect(330, 30, 80, 60)) = 0.5;
    return inverse;
  }
  double share(const cv::Mat& inverse, const DepthRange& range, const StereogramOptions& options,
               const cv::Mat& pattern = {}) {
    Stereogram stereogram(inverse.cols, inverse.rows, pattern);
    stereogram(depth_of(inverse), range, options);
    drawn_ = stereogram.read();
    decoded_ = decode_stereogram(drawn_, options.depth.least(), options.depth.most());
    return share_decoded(nearness(inverse, range), decoded_, options.depth, 1);
  }
  static cv::Mat sample_pattern() {
    cv::Mat noise(64, 64, CV_8UC3), out;
    cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(noise, out, {}, 1.2);
    return out;
  }

  static Lens lens() {
    Lens::Parameters p;
    p.width = 480;
    p.height = 320;
    p.fx = p.fy = 420;
    p.cx = 239.5;
    p.cy = 159.5;
    return Lens(p);
  }
  /// Of that scene through that lens; 0 where nothing is.
  static cv::Mat inverse_of(const SceneModel& scene) {
    const gl::FaceImages faces(gl::faces_for(lens(), 0), false);
    gl::RasterPass(std::make_shared<gl::SceneBuffers>(scene), false)(usual_view(), state_of(scene), faces);
    return gl::read_texture(faces.depth) / gl::kNearPlane;
  }

  const DepthRange range_{1, 2};
  cv::Mat drawn_, decoded_;
};

// Twenty steps of a pixel.
TEST_F(StereogramTest, DepthComesBackOfDotsAndOfAPatternBothWays) {
  for (const bool inverted : {false, true})
    for (const StripPictures pictures : {StripPictures::one, StripPictures::two})
      for (const bool dots : {true, false}) {
        StereogramOptions options;
        options.depth = {200, 1 / 3., inverted};
        options.pictures = pictures;
        EXPECT_GE(share(shapes(), range_, options, dots ? cv::Mat() : sample_pattern()), 0.85)
            << "inverted " << inverted << ", pictures " << static_cast<int>(pictures) << ", dots " << dots;
      }
}

TEST_F(StereogramTest, OnePictureOrTwoInTurnAreTheSame) {
  StereogramOptions options;
  share(shapes(), range_, options);
  const cv::Mat one = drawn_.clone();
  options.pictures = StripPictures::two;
  share(shapes(), range_, options);
  EXPECT_EQ(cv::norm(one, drawn_, cv::NORM_INF), 0);
}

TEST_F(StereogramTest, WhatOnlyOneEyeSeesIsLinkedToNothing) {
  StereogramOptions options;
  options.depth = {200, 0.6, false};
  const double cut = share(shapes(), range_, options);
  options.hides = false;
  // Each point is where it is seen from the middle between the eyes: half a separation to the side of where it is.
  EXPECT_LT(share(shapes(), range_, options), cut - 0.1);
}

// A slope of less than a pixel from end to end of many columns: steps of whole ones are off by up to half.
TEST_F(StereogramTest, FractionsOfAPixelMakeSlopesOfTerraces) {
  cv::Mat slope(kHeight, kWidth, CV_32F);
  for (int x = 0; x < kWidth; ++x) slope.col(x) = 0.5 + 0.15 * x / kWidth;
  StereogramOptions options;
  options.depth = {200, 1 / 3., false};
  options.dot = 3;
  const auto error = [&] {
    share(slope, range_, options);
    const cv::Mat z = nearness(slope, range_);
    double sum = 0;
    int count = 0;
    for (int x = 0; x < kWidth; ++x) {
      const double s = options.depth.separation(z.at<float>(60, x));
      const int at = static_cast<int>(std::lround(x + 0.5 * s));
      if (at >= kWidth || decoded_.at<float>(60, at) == 0) continue;
      sum += std::abs(decoded_.at<float>(60, at) - s);
      ++count;
    }
    return sum / count;
  };
  const double smooth = error();
  options.smooth = false;
  EXPECT_LT(smooth, 0.75 * error());
}

TEST_F(StereogramTest, FramesOfAnAnimationHaveNothingInCommonButTheirDepth) {
  for (const bool dots : {true, false}) {
    StereogramOptions options;
    EXPECT_GT(share(shapes(), range_, options, dots ? cv::Mat() : sample_pattern()), 0.8);
    const cv::Mat first = drawn_.clone();
    options.frame = 1;
    EXPECT_GT(share(shapes(), range_, options, dots ? cv::Mat() : sample_pattern()), 0.8);
    cv::Mat same;
    cv::inRange(cv::abs(first - drawn_), cv::Scalar(0, 0, 0), cv::Scalar(8, 8, 8), same);
    EXPECT_LT(cv::countNonZero(same), 0.2 * static_cast<double>(same.total())) << dots;
  }
}

TEST_F(StereogramTest, AFloaterIsSeenAtItsDepth) {
  StereogramOptions options;
  options.depth = {200, 1 / 3., false};
  Stereogram stereogram(kWidth, kHeight);
  stereogram(depth_of(shapes()), range_, options);
  const cv::Mat mark(9, 9, CV_8UC4, cv::Scalar(0, 0, 255, 255));
  stereogram.float_over({mark, 240, 60, 0.5});
  const cv::Mat drawn = stereogram.read();
  cv::Mat red;
  cv::inRange(drawn, cv::Scalar(0, 0, 255), cv::Scalar(0, 0, 255), red);
  std::vector<int> begins;
  for (int x = 1; x < kWidth; ++x)
    if (red.at<std::uint8_t>(60, x) && !red.at<std::uint8_t>(60, x - 1)) begins.push_back(x);
  ASSERT_GE(begins.size(), 4u);
  for (std::size_t i = 1; i < begins.size(); ++i)
    EXPECT_NEAR(begins[i] - begins[i - 1], options.depth.separation(0.5), 1);
}

TEST_F(StereogramTest, ASceneThatIsDrawnComesBack) {
  const auto scene = small_scene();
  const cv::Mat inverse = inverse_of(*scene);
  StereogramOptions options;
  options.depth.eye_distance = 200;
  EXPECT_GE(share(inverse, depth_range(inverse), options), 0.8);
}

// As the window shows it: whatever the keys choose, near is nearer, the other way round for eyes that cross.
TEST_F(StereogramTest, EveryKeysChoiceTellsTheScenesDepth) {
  const auto scene = small_scene();
  const cv::Mat inverse = inverse_of(*scene), seen = inverse > 0;
  LiveStereogram live(gl::RasterPass(std::make_shared<gl::SceneBuffers>(*scene), false));
  cv::Mat before;
  const auto spread_of = [&](const StereogramLook& look) {  // px from far to near; negative: near is far
    live.draw(look, usual_view(), state_of(*scene), lens(), inverse.cols, inverse.rows);
    const cv::Mat drawn = gl::read_texture(live.picture());
    if (!before.empty()) {
      EXPECT_GT(cv::norm(before, drawn, cv::NORM_L1) / static_cast<double>(drawn.total()), 10) << "other dots";
    }
    before = drawn;
    cv::Mat picture;
    cv::cvtColor(drawn, picture, cv::COLOR_BGRA2BGR);
    const cv::Mat decoded = decode_stereogram(picture, 8, inverse.cols / 8.0), known = seen & (decoded > 0);
    cv::Scalar mean_z, spread_z, mean_s, spread_s;
    cv::meanStdDev(inverse, mean_z, spread_z, known);
    cv::meanStdDev(decoded, mean_s, spread_s, known);
    const double together = cv::mean(inverse.mul(decoded), known)[0] - mean_z[0] * mean_s[0];
    const double least = look.pattern == 2 ? 0.7 : 0.8;  // clouds are soft: some of their places are taken for others
    EXPECT_GT(std::abs(together) / (spread_z[0] * spread_s[0]), least) << look.words();
    return -std::copysign(spread_s[0], together);
  };
  StereogramLook look;
  std::array<double, 3> spread{};
  for (int i = 0; i < 3; ++i, look.next_depth()) spread[static_cast<std::size_t>(look.depth)] = spread_of(look);
  EXPECT_GT(spread[0], 0.3);
  EXPECT_GT(spread[1], 1.5 * spread[0]);
  EXPECT_GT(spread[2], 1.3 * spread[1]);
  for (look.next_pattern(); look.pattern != 0; look.next_pattern())
    EXPECT_NEAR(spread_of(look), spread[1], 0.2 * spread[1]) << look.words();
  for (look.next_variant(); look.variant != 0; look.next_variant())
    EXPECT_NEAR(spread_of(look), look.variant < 2 ? spread[1] : -spread[1], 0.2 * spread[1]) << look.words();
  std::set<std::string> words;
  for (int i = 0; i < 36; ++i) {
    words.insert(look.words());
    look.next_depth();
    if (i % 3 == 2) look.next_pattern();
    if (i % 9 == 8) look.next_variant();
  }
  EXPECT_EQ(words.size(), 36u) << "each says what it is";
}

TEST_F(StereogramTest, WhatItCannotDrawIsRefused) {
  Stereogram stereogram(kWidth, kHeight);
  const gl::Texture depth = depth_of(shapes());
  StereogramOptions options;
  options.depth.eye_distance = 20;
  EXPECT_THROW(stereogram(depth, range_, options), std::invalid_argument);
  options.depth.eye_distance = 3 * kWidth;
  EXPECT_THROW(stereogram(depth, range_, options), std::invalid_argument);
  options.depth.eye_distance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(stereogram(depth, range_, options), std::invalid_argument);
  EXPECT_THROW(stereogram(depth, {2, 1}, {}), std::invalid_argument);
  EXPECT_THROW(stereogram(depth_of(cv::Mat(8, 8, CV_32F, cv::Scalar(1))), range_, {}), std::invalid_argument);
}

}  // namespace
}  // namespace foresight::stereogram_test
