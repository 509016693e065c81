#include "link/coding/jpeg_coder.hpp"

#include "link/send_control/line_trial.hpp"
#include "tests/support/moving_picture.hpp"

namespace foresight::jpeg_coder_test {
namespace {

TEST(JpegCoder, CodesAPairToTheBudget) {
  JpegPairEncoder encoder;
  const StereoPicture picture = moving_picture({});
  for (const std::size_t budget : {5000U, 3000U}) {
    CodedPair pair;
    for (std::uint32_t i = 1; i < 9; ++i) pair = encoder.encode(picture, {.number = i, .bytes = budget});
    EXPECT_NEAR(static_cast<double>(pair.data.size()), static_cast<double>(budget), 0.25 * static_cast<double>(budget));
    const std::optional<StereoPicture> back = decode_jpeg(pair);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->captured, picture.captured);
    EXPECT_GT(luma_psnr_db(picture, *back), 25);
  }
}

TEST(JpegCoder, CodesGreyAndSinglePictures) {
  JpegPairEncoder encoder;
  StereoPicture picture = moving_picture({}, {97, 63}, false);
  picture.right.release();
  const std::optional<StereoPicture> back = decode_jpeg(encoder.encode(picture, {}));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->left.type(), CV_8UC1);
  EXPECT_EQ(back->left.size(), cv::Size(97, 63));
  EXPECT_TRUE(back->right.empty());
}

TEST(JpegCoder, RefusesPicturesOfAnotherSizeThanTheirPairs) {
  JpegPairEncoder encoder;
  CodedPair pair = encoder.encode(moving_picture({}), {});
  pair.width += 2;
  EXPECT_FALSE(decode_jpeg(pair));
  pair.width -= 2;
  EXPECT_TRUE(decode_jpeg(pair));
  pair.data.resize(pair.data.size() - 40);
  EXPECT_FALSE(decode_jpeg(pair));
}

}  // namespace
}  // namespace foresight::jpeg_coder_test
