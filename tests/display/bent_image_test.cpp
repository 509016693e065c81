// A camera's image through another lens: each pixel has what the camera saw in that pixel's direction.
#include "display/bent_image.hpp"

#include "display/uploaded_picture.hpp"
#include "gl/read_texture.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::bent_image_test {
namespace {

class BentImageTest : public HeadlessTest {
 protected:
  /// Its colours say where a pixel lies: green along x, red along y.
  static cv::Mat ramps(int width, int height) {
    cv::Mat out(height, width, CV_8UC3);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        out.at<cv::Vec3b>(y, x) = {77, cv::saturate_cast<std::uint8_t>(255.0 * x / (width - 1)),
                                   cv::saturate_cast<std::uint8_t>(255.0 * y / (height - 1))};
    return out;
  }
};

TEST_F(BentImageTest, EachPixelShowsWhatTheCameraSawInItsDirection) {
  const Lens pinhole = small_lens("pinhole");
  UploadedPicture image("image");
  image.upload(ramps(pinhole.width(), pinhole.height()));
  for (const char* of_camera : {"pinhole", "plumb_bob", "fisheye"})
    for (const char* of_eye : {"pinhole", "rational", "fisheye"}) {
      const Lens camera = small_lens(of_camera), eye = small_lens(of_eye);
      BentImage bent(camera);
      const cv::Mat seen = gl::read_texture(bent(image.texture(), eye));
      int compared = 0, black = 0;
      for (int y = 0; y < eye.height(); ++y)
        for (int x = 0; x < eye.width(); ++x) {
          const auto ray = eye.unproject({x, y});
          const auto at = ray ? camera.project(*ray) : std::nullopt;
          const cv::Vec4b& pixel = seen.at<cv::Vec4b>(y, x);
          ASSERT_EQ(pixel[3], 255);
          if (!at || at->x() < -1 || at->y() < -1 || at->x() > camera.width() || at->y() > camera.height()) {
            ASSERT_EQ(pixel[0] + pixel[1] + pixel[2], 0) << of_camera << " " << of_eye << " " << x << " " << y;
            ++black;
          } else if (at->x() > 0 && at->y() > 0 && at->x() < camera.width() - 1 && at->y() < camera.height() - 1) {
            ASSERT_NEAR(pixel[1], 255 * at->x() / (camera.width() - 1), 1.5) << of_camera << " " << of_eye;
            ASSERT_NEAR(pixel[0], 255 * at->y() / (camera.height() - 1), 1.5) << of_camera << " " << of_eye;
            ++compared;
          }
        }
      EXPECT_GT(compared, 1000) << of_camera << " " << of_eye;
      if (std::string(of_camera) == of_eye) {
        EXPECT_EQ(black, 0);
      }
    }
}

// As images come smaller over thin lines.
TEST_F(BentImageTest, AnImageOfFewerPixelsIsAsLarge) {
  const Lens lens = small_lens("pinhole");
  UploadedPicture image("image");
  image.upload(ramps(lens.width() / 2, lens.height() / 2));
  const cv::Mat seen = gl::read_texture(BentImage(lens)(image.texture(), lens));
  EXPECT_NEAR(seen.at<cv::Vec4b>(60, 40)[1], 255.0 * 40 / 159, 2.5);
  EXPECT_NEAR(seen.at<cv::Vec4b>(90, 120)[0], 255.0 * 90 / 119, 2.5);
}

}  // namespace
}  // namespace foresight::bent_image_test
