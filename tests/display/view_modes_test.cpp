// How large views are, where borders lie, and what two pictures in one look like.
#include "display/view_modes.hpp"

#include <bit>

#include "display/picture_mix.hpp"
#include "display/uploaded_picture.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::view_modes_test {
namespace {

TEST(ViewModes, AFittedLensSeesTheSame) {
  for (const char* kind : kLensKinds) {
    const Lens camera = small_lens(kind), large = fitted_lens(camera, 640, 400), small = fitted_lens(camera, 40, 100);
    EXPECT_EQ(large.height(), 400) << kind;
    EXPECT_EQ(small.width(), 40) << kind;
    for (const Lens& lens : {large, small}) {
      const Eigen::Array2d scale(lens.width() / static_cast<double>(camera.width()),
                                 lens.height() / static_cast<double>(camera.height()));
      EXPECT_NEAR(scale.x(), scale.y(), 0.01) << kind;
      for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.1, -0.2, 1), {-0.3, 0.25, 1}, {0, 0, 2}}) {
        const Eigen::Array2d expected = (camera.project(p)->array() + 0.5) * scale - 0.5;
        EXPECT_LT((lens.project(p)->array() - expected).matrix().norm(), 1e-9) << kind;
      }
    }
  }
}

/// The pixels that are drawn besides the camera's in the end, where a pixel costs so many ns.
int settled(ViewSize& size, int width, int height, double ns_per_pixel, int* changes = nullptr) {
  const auto beside = [&] { return size.lens() ? size.lens()->width() * size.lens()->height() : 0; };
  for (int i = 0; i < 4000; ++i) {
    const int before = beside();
    const double noise = 1 + 0.08 * ((i * 7) % 5 - 2);
    size.choose(width, height, 1e-6 * ns_per_pixel * (size.own().width() * size.own().height() + before) * noise);
    if (changes && beside() != before) ++*changes;
  }
  return beside();
}

TEST(ViewModes, ViewsAreAsLargeAsTheirPlaceWhereTheRendererCan) {
  const Lens camera = small_lens("pinhole");  // 160 x 120
  ViewSize quick(camera, 20);
  EXPECT_FALSE(quick.lens()) << "nothing is known yet";
  EXPECT_EQ(settled(quick, 1280, 800, 1), 1066 * 800);
  EXPECT_EQ(settled(quick, 1000, 800, 1), 1000 * 750) << "another place";
  EXPECT_EQ(settled(quick, 80, 300, 1), 0) << "the camera's own is larger";
  ViewSize slow(camera, 20);
  int changes = 0;
  const int pixels = settled(slow, 1280, 800, 200, &changes);  // 20 ms for 100,000 px in all
  EXPECT_GT(pixels, 55'000);
  EXPECT_LT(pixels, 110'000);
  EXPECT_LT(changes, 8) << "it does not swing";
  for (const double ns_per_pixel : {350.0, 450.0, 600.0, 1e5}) {  // little or nothing is left beside the camera's
    ViewSize slowest(camera, 20);
    changes = 0;
    settled(slowest, 1280, 800, ns_per_pixel, &changes);
    EXPECT_LT(changes, 8) << ns_per_pixel;
  }
  ViewSize slowest(camera, 20);
  EXPECT_EQ(settled(slowest, 1280, 800, 1e5), 0);
}

TEST(ViewModes, WhereDrawingTakesTooLongViewsAreSmaller) {
  const Lens camera = small_lens("plumb_bob");  // 160 x 120
  for (const double ns_per_pixel : {500.0, 900.0, 1300.0, 2000.0, 1e5}) {
    ViewSize size(camera, 10, 0);  // 20,000 px at 500 ns
    EXPECT_EQ(size.scale(), 1);
    int changes = 0;
    settled(size, 1280, 800, ns_per_pixel, &changes);
    const double pixels = size.own().width() * size.own().height(), possible = 1e7 / ns_per_pixel;
    EXPECT_FALSE(size.lens());
    EXPECT_LE(changes, 1) << ns_per_pixel;
    EXPECT_LE(pixels, std::max(1.2 * possible, 0.26 * 160 * 120)) << ns_per_pixel;
    EXPECT_GE(pixels, std::max(0.65 * std::min(possible, 160.0 * 120), 0.24 * 160 * 120)) << ns_per_pixel;
    EXPECT_NEAR(size.own().width() / 160.0, size.scale(), 0.01);
    EXPECT_NEAR(size.own().height() / 120.0, size.scale(), 0.01);
    EXPECT_EQ(size.own().parameters().d, camera.parameters().d);
    EXPECT_NEAR(size.own().max_angle(), camera.max_angle(), 1e-3) << "it sees as much as before";
  }
  ViewSize size(camera, 10, 0);
  settled(size, 1280, 800, 1500);
  EXPECT_LT(size.scale(), 0.75);
  settled(size, 1280, 800, 100);
  EXPECT_EQ(size.scale(), 1) << "there is time again";
  EXPECT_TRUE(size.lens());
  EXPECT_EQ(size.own().width(), 160);
}

TEST(ViewModes, TwoEyesShareTheTime) {
  const Lens camera = small_lens("pinhole");
  const std::array eyes{camera, camera};
  ViewSize size(camera, 10, 0);
  int changes = 0;
  for (int i = 0; i < 400; ++i) {
    const double before = size.scale();
    size.choose_for(eyes, 800, 600, 1e-6 * 400 * 3 * 160 * 120 * before * before);  // 25,000 px in time, of 57,600
    changes += size.scale() != before;
    EXPECT_FALSE(size.lens());
  }
  EXPECT_EQ(changes, 1);
  EXPECT_NEAR(size.scale() * size.scale(), 25'000 / 57'600.0, 0.01);
  for (int i = 0; i < 400; ++i) size.choose_for(eyes, 800, 600, 0);
  EXPECT_EQ(size.scale(), 1) << "nothing is known any more";
}

// There, drawing hardly becomes cheaper.
TEST(ViewModes, FewPixelsBecomeNoFewer) {
  for (const auto& [width, least] : {std::pair{160, 160}, {320, 320}, {480, 320}, {640, 320}, {1280, 640}}) {
    ViewSize size(fitted_lens(small_lens("pinhole"), width, width), 10);
    settled(size, 1280, 800, 1e5);
    EXPECT_NEAR(size.own().width(), least, 1) << width;
  }
}

// Mesa's software renderer would compile programs anew.
TEST(ViewModes, NoSideOfASmallerViewIsAPowerOfTwo) {
  const Lens camera = small_lens("pinhole");
  for (double scale = 0.3; scale < 1; scale += 0.01) {
    const Lens lens = scaled_lens(camera, scale);
    EXPECT_FALSE(std::has_single_bit(static_cast<unsigned>(lens.width()))) << scale;
    EXPECT_FALSE(std::has_single_bit(static_cast<unsigned>(lens.height()))) << scale;
    EXPECT_NEAR(lens.width(), 160 * scale, 2);
  }
  EXPECT_EQ(scaled_lens(camera, 1).width(), 160);
}

TEST(ViewModes, TheBorderIsTakenWhereItLiesAndKeptInside) {
  SplitBorder border;
  EXPECT_FALSE(border.drag(100, 400, true, true)) << "beside it";
  EXPECT_FALSE(border.drag(200, 400, false, true)) << "it was not pressed there";
  EXPECT_FALSE(border.drag(200, 400, false, false));
  EXPECT_TRUE(border.drag(205, 400, true, true));
  EXPECT_TRUE(border.drag(300, 400, false, true));
  EXPECT_DOUBLE_EQ(border.at(), 0.75);
  EXPECT_TRUE(border.drag(900, 400, false, true));
  EXPECT_LT(border.at(), 1);
  EXPECT_FALSE(border.drag(0, 400, false, false)) << "let go of";
  EXPECT_GT(border.at(), 0.9);
  EXPECT_FALSE(border.drag(0, 0, true, true));
}

class PictureMixTest : public HeadlessTest {
 protected:
  static gl::Texture plain(int width, int height, std::array<std::uint8_t, 4> rgba) {
    gl::Texture out(GL_RGBA8, width, height, 0, 1, "plain");
    glClearTexImage(out.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    return out;
  }
  cv::Mat mixed(PictureMix::Options options, int width = 12, int height = 6) {
    const gl::Texture first = plain(6, 6, {200, 100, 50, 255}), second = plain(24, 12, {10, 120, 240, 128});
    PictureMix mix;
    const gl::Texture& picture = mix(first, second, width, height, options);
    cv::Mat out(height, width, CV_8UC4);
    glGetTextureImage(picture.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
    return out;
  }
};

const cv::Vec4b kFirst(200, 100, 50, 255), kSecond(10, 120, 240, 255);

TEST_F(PictureMixTest, RowsTakeTurns) {
  const cv::Mat even = mixed({PictureMix::Way::rows}), odd = mixed({PictureMix::Way::rows, 0.5, true});
  for (int y = 0; y < even.rows; ++y)
    for (int x = 0; x < even.cols; ++x) {
      EXPECT_EQ(even.at<cv::Vec4b>(y, x), y % 2 ? kSecond : kFirst);
      EXPECT_EQ(odd.at<cv::Vec4b>(y, x), y % 2 ? kFirst : kSecond);
    }
}

TEST_F(PictureMixTest, TheBorderParts) {
  const cv::Mat picture = mixed({PictureMix::Way::split, 0.25});
  EXPECT_EQ(picture.at<cv::Vec4b>(3, 0), kFirst);
  EXPECT_EQ(picture.at<cv::Vec4b>(3, 6), kSecond);
  EXPECT_NE(picture.at<cv::Vec4b>(3, 3), kFirst) << "it is seen itself";
  EXPECT_NE(picture.at<cv::Vec4b>(3, 3), kSecond);
}

TEST_F(PictureMixTest, SpectaclesPartTheEyes) {
  const auto luma = [](const cv::Vec4b& c) { return 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]; };
  const cv::Vec4b grey = mixed({PictureMix::Way::anaglyph}).at<cv::Vec4b>(2, 2),
                  colours = mixed({PictureMix::Way::anaglyph_colours}).at<cv::Vec4b>(2, 2);
  EXPECT_NEAR(grey[0], luma(kFirst), 1);
  EXPECT_NEAR(grey[1], luma(kSecond), 1);
  EXPECT_NEAR(grey[2], luma(kSecond), 1);
  EXPECT_NEAR(colours[0], luma(kFirst), 1);
  EXPECT_NEAR(colours[1], kSecond[1], 1);
  EXPECT_NEAR(colours[2], kSecond[2], 1);
}

TEST_F(PictureMixTest, PicturesAreScaledWithoutShift) {
  cv::Mat ramp(4, 16, CV_8UC3);
  for (int x = 0; x < 16; ++x) ramp.col(x).setTo(cv::Scalar::all(8 + 16 * x));
  UploadedPicture source("ramp");
  source.upload(ramp);
  PictureMix mix;
  const gl::Texture& picture = mix(source.texture(), source.texture(), 64, 4, {PictureMix::Way::rows});
  cv::Mat out(4, 64, CV_8UC4);
  glGetTextureImage(picture.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
  for (int x = 2; x < 62; ++x) EXPECT_NEAR(out.at<cv::Vec4b>(1, x)[0], 4 * (x + 0.5), 1.5) << x;
}

}  // namespace
}  // namespace foresight::view_modes_test
