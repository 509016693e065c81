// Pictures land where they are wanted, upright, and nowhere else.
#include "display/view_target.hpp"

#include "display/uploaded_picture.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::view_target_test {
namespace {

using Pixel = std::array<std::uint8_t, 4>;

class ViewTargetTest : public HeadlessTest {
 protected:
  /// Four fields of 1 px: red, green / blue, white.
  static cv::Mat fields() {
    cv::Mat picture(2, 2, CV_8UC3);
    picture.at<cv::Vec3b>(0, 0) = {0, 0, 255};
    picture.at<cv::Vec3b>(0, 1) = {0, 255, 0};
    picture.at<cv::Vec3b>(1, 0) = {255, 0, 0};
    picture.at<cv::Vec3b>(1, 1) = {255, 255, 255};
    return picture;
  }
  static std::vector<Pixel> read(const gl::Texture& texture, int layer = 0) {
    std::vector<Pixel> out(static_cast<std::size_t>(texture.width()) * static_cast<std::size_t>(texture.height()));
    glGetTextureSubImage(texture.name(), 0, 0, 0, layer, texture.width(), texture.height(), 1, GL_RGBA,
                         GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.size() * 4), out.data());
    return out;
  }
  static void set_all(const gl::Texture& texture) {
    const Pixel sentinel{9, 8, 7, 6};
    glClearTexImage(texture.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, sentinel.data());
  }
};

constexpr Pixel kRed{255, 0, 0, 255}, kGreen{0, 255, 0, 255}, kBlue{0, 0, 255, 255}, kWhite{255, 255, 255, 255},
    kSentinel{9, 8, 7, 6};

TEST(ViewTarget, FitsPicturesIntoTheMiddle) {
  const ViewTarget wide{.framebuffer = 3, .x = 10, .y = 20, .width = 400, .height = 100, .first_row_at_top = true};
  EXPECT_EQ(fitted(wide, 320, 240), (ViewTarget{3, 10 + (400 - 133) / 2, 20, 133, 100, true}));
  EXPECT_EQ(fitted({.width = 90, .height = 400}, 30, 10), (ViewTarget{.y = 185, .width = 90, .height = 30}));
  EXPECT_EQ(column({.x = 5, .width = 106, .height = 50}, 1, 2, 2),
            (ViewTarget{.x = 59, .y = 2, .width = 50, .height = 46}));
}

TEST_F(ViewTargetTest, WindowsBeginAtTheBottomAndOurPicturesAtTheTop) {
  UploadedPicture picture("picture");
  picture.upload(fields());
  const gl::Texture beyond(GL_RGBA8, 2, 2, 0, 1, "target");
  const PictureCopy copy;
  copy(picture.texture(), TextureTarget(beyond.name(), 2, 2).whole());
  EXPECT_EQ(read(beyond), (std::vector<Pixel>{kRed, kGreen, kBlue, kWhite}));
  copy(picture.texture(), TextureTarget(beyond.name(), 2, 2, -1, false).whole());
  EXPECT_EQ(read(beyond), (std::vector<Pixel>{kBlue, kWhite, kRed, kGreen}));
}

// As a head display lends them: one texture with a layer for each eye, or one with both eyes side by side.
TEST_F(ViewTargetTest, TwoEyesFitIntoForeignTextures) {
  UploadedPicture left("left"), right("right");
  left.upload(fields());
  right.upload(cv::Scalar::all(255) - fields());
  const PictureCopy copy;
  const gl::Texture layers(GL_RGBA8, 2, 2, 2, 1, "two layers");
  copy(left.texture(), TextureTarget(layers.name(), 2, 2, 0).whole());
  copy(right.texture(), TextureTarget(layers.name(), 2, 2, 1).whole());
  EXPECT_EQ(read(layers, 0).front(), kRed);
  EXPECT_EQ(read(layers, 1).front(), (Pixel{0, 255, 255, 255}));

  const gl::Texture both(GL_RGBA8, 8, 4, 0, 1, "side by side");
  set_all(both);
  const TextureTarget target(both.name(), 8, 4);
  ViewTarget eye = target.whole();
  eye.width = 2, eye.height = 2, eye.y = 1;
  eye.x = 1;
  copy(left.texture(), eye);
  eye.x = 5;
  copy(right.texture(), eye);
  const auto pixels = read(both);
  EXPECT_EQ(pixels[8 + 1], kRed);
  EXPECT_EQ(pixels[16 + 2], kWhite);
  EXPECT_EQ(pixels[8 + 5], (Pixel{0, 255, 255, 255}));
  EXPECT_EQ(std::ranges::count(pixels, kSentinel), 32 - 8) << "outside of both nothing is touched";
}

TEST_F(ViewTargetTest, FillsItsRectangleOnly) {
  const gl::Texture beyond(GL_RGBA8, 4, 4, 0, 1, "target");
  set_all(beyond);
  const TextureTarget target(beyond.name(), 4, 4);
  ViewTarget part = target.whole();
  part.x = part.y = 1;
  part.width = 2, part.height = 3;
  fill(part, 0, 1, 0);
  EXPECT_EQ(std::ranges::count(read(beyond), kGreen), 6);
  EXPECT_EQ(std::ranges::count(read(beyond), kSentinel), 10);
}

TEST_F(ViewTargetTest, GreyPicturesAreGrey) {
  UploadedPicture picture("picture");
  picture.upload(cv::Mat(1, 2, CV_8UC1, cv::Scalar(77)));
  EXPECT_EQ(read(picture.texture()), (std::vector<Pixel>{{77, 77, 77, 255}, {77, 77, 77, 255}}));
  picture.upload(fields());
  EXPECT_EQ(read(picture.texture()).front(), kRed) << "another size and kind";
}

}  // namespace
}  // namespace foresight::view_target_test
