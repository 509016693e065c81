#include <opencv2/imgproc.hpp>

#include "pictures/image_structure.hpp"
#include "scene/run_folder.hpp"
#include "test_run.hpp"

namespace foresight::image_test {
namespace {

class Image : public testing::Test {
 protected:
  cv::Mat read(const std::string& bytes) {
    RunImage image;
    image.file = folder_.write("image.bin", bytes);
    return read_run_image(image, lens_);
  }
  std::string error(const std::string& bytes) {
    return input_error([&] { read(bytes); });
  }

  TempFolder folder_;
  Lens lens_{Lens::Parameters{LensModel::plumb_bob, 8, 6, 10, 10, 3.5, 2.5, {}}};
};

TEST_F(Image, ReadsColourAndGrey) {
  const cv::Mat colour = read(encoded(".png", test_pixels()));
  EXPECT_EQ(colour.type(), CV_8UC3);
  EXPECT_EQ(cv::norm(colour, test_pixels(), cv::NORM_INF), 0);
  const cv::Mat grey = read(encoded(".png", test_pixels(CV_8UC1)));
  EXPECT_EQ(grey.type(), CV_8UC1);
  EXPECT_EQ(cv::norm(grey, test_pixels(CV_8UC1), cv::NORM_INF), 0);
  EXPECT_EQ(read(encoded(".jpg", test_pixels())).type(), CV_8UC3);
  EXPECT_EQ(read(encoded(".jpg", test_pixels(CV_8UC1))).type(), CV_8UC1);
}

// An APP1 segment that asks for a rotation by 90 degrees.
std::string with_exif_orientation(const std::string& jpeg) {
  const std::string exif("Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0", 32);
  const std::string segment = std::string("\xFF\xE1\0", 3) + static_cast<char>(exif.size() + 2) + exif;
  return jpeg.substr(0, 2) + segment + jpeg.substr(2);
}

TEST_F(Image, IgnoresTheExifOrientation) {
  const std::string plain = encoded(".jpg", test_pixels()), turned = with_exif_orientation(plain);
  const cv::Mat probe = cv::imdecode(std::vector<uchar>(turned.begin(), turned.end()), cv::IMREAD_COLOR);
  ASSERT_EQ(probe.cols, 6) << "the probe does not carry an orientation that OpenCV sees";
  EXPECT_EQ(cv::norm(read(turned), read(plain), cv::NORM_INF), 0);
}

TEST_F(Image, EveryTruncationIsAnError) {
  for (const char* extension : {".png", ".jpg"}) {
    const std::string whole = encoded(extension, test_pixels());
    ASSERT_EQ(error(whole), "no error");
    for (std::size_t n = 1; n < whole.size(); ++n)
      ASSERT_THAT(error(whole.substr(0, n)), says("image.bin", "", "")) << extension << " " << n;
    EXPECT_THAT(error(whole.substr(0, whole.size() - 1)),
                says("image.bin", "truncated after", "copy or record it again"));
  }
  EXPECT_THAT(error(""), says("image.bin", "is empty", "record it again"));
}

TEST_F(Image, TruncationIsSeenWhereOpenCvFillsWithGrey) {
  cv::Mat big(480, 640, CV_8UC3);
  cv::randu(big, 0, 255);
  const std::string half = encoded(".jpg", big).substr(0, 100'000);
  ASSERT_FALSE(cv::imdecode(std::vector<uchar>(half.begin(), half.end()), cv::IMREAD_COLOR).empty())
      << "OpenCV has learned to refuse it";
  EXPECT_THAT(input_error([&] { read_image_form(half, "x.jpg"); }),
              says("x.jpg", "truncated after 100000 bytes", "copy"));
}

TEST_F(Image, EveryFlippedByteOfAPngIsAnError) {
  const std::string whole = encoded(".png", test_pixels());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_NE(error(damaged), "no error") << "byte " << i;
  }
}

TEST_F(Image, PixelDataThatEndEarlyInAWholePngAreAnError) {
  // The zlib stream is cut, but chunk length and CRC fit again.
  const std::string whole = encoded(".png", test_pixels());
  const std::size_t idat = whole.find("IDAT");
  const auto byte = [&](std::size_t at) { return static_cast<std::size_t>(static_cast<unsigned char>(whole[at])); };
  const std::size_t length = byte(idat - 2) << 8 | byte(idat - 1);
  std::string body = whole.substr(idat, 4 + length / 2);
  std::uint32_t c = 0xFFFFFFFF;
  for (char b : body) {
    c ^= static_cast<unsigned char>(b);
    for (int k = 0; k < 8; ++k) c = (c & 1) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
  }
  c = ~c;
  std::string damaged = whole.substr(0, idat - 4);
  for (std::uint32_t v : {static_cast<std::uint32_t>(length / 2), 0u, c}) {
    if (v == 0)
      damaged += body;
    else
      for (int shift : {24, 16, 8, 0}) damaged += static_cast<char>(v >> shift);
  }
  damaged += whole.substr(idat + 8 + length);
  EXPECT_EQ(input_error([&] { read_image_form(damaged, "x.png"); }), "no error");
  EXPECT_THAT(error(damaged), says("image.bin", "cannot be decoded", "record it again"));
}

TEST_F(Image, RefusesOtherDepthsAndChannels) {
  EXPECT_THAT(error(encoded(".png", cv::Mat(6, 8, CV_16UC1, cv::Scalar(1)))),
              says("image.bin", "16 bits per sample", "convert it to 8-bit"));
  EXPECT_THAT(error(encoded(".png", cv::Mat(6, 8, CV_16UC3, cv::Scalar(1)))),
              says("image.bin", "16 bits per sample", "convert it to 8-bit"));
  EXPECT_THAT(error(encoded(".png", cv::Mat(6, 8, CV_8UC4, cv::Scalar(1)))),
              says("image.bin", "alpha", "without alpha"));
  std::string cmyk = encoded(".jpg", test_pixels());
  const std::size_t sof = cmyk.find("\xFF\xC0");
  ASSERT_NE(sof, std::string::npos);
  cmyk[sof + 9] = 4;
  EXPECT_THAT(error(cmyk), says("image.bin", "4 channels", "convert"));
}

TEST_F(Image, RefusesAnotherSizeAndFormat) {
  cv::Mat other(5, 8, CV_8UC3, cv::Scalar(1));
  EXPECT_THAT(error(encoded(".png", other)), says("image.bin", "is 8x5, its camera file says 8x6", "image_width"));
  EXPECT_THAT(error(encoded(".jpg", other)), says("image.bin", "is 8x5, its camera file says 8x6", "image_width"));
  EXPECT_THAT(error(encoded(".bmp", test_pixels())), says("image.bin", "neither PNG nor JPEG", "convert it to PNG"));
  EXPECT_THAT(error("text"), says("image.bin", "neither PNG nor JPEG", "convert it to PNG"));
}

TEST_F(Image, AHugeSizeInTheHeaderIsRefusedBeforeDecoding) {
  std::string jpeg = encoded(".jpg", test_pixels());
  const std::size_t sof = jpeg.find("\xFF\xC0");
  for (int i = 5; i < 9; ++i) jpeg[sof + static_cast<std::size_t>(i)] = '\xFF';
  EXPECT_THAT(error(jpeg), says("image.bin", "is 65535x65535", "camera file"));
}

TEST(CheckRunImages, ReportsTheFirstBadImageInRunOrder) {
  TestRun run;
  std::string rgb, trajectory;
  for (int i = 0; i < 60; ++i) {
    const std::string time = std::to_string(i / 10) + "." + std::to_string(i % 10);
    rgb += time + " many/" + std::to_string(i) + ".png\n";
    trajectory += time + " 0 0 0 0 0 0 1\n";
    run.write("many/" + std::to_string(i) + ".png", run.read("rgb/a.png"));
  }
  run.write("rgb.txt", rgb);
  run.write("trajectory.txt", trajectory);
  const RunFolder folder = RunFolder::open(run.path(), {});
  std::vector<std::size_t> told;
  const auto progress = [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 60u);
    told.push_back(done);
  };
  check_run_images(folder, progress);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back(), 60u);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  check_run_images(folder, {});

  for (int bad : {59, 31, 30, 7}) {  // the last is the first in the run
    run.write("many/" + std::to_string(bad) + ".png", "x");
    EXPECT_THAT(input_error([&] { check_run_images(folder, progress); }),
                says(std::to_string(bad) + ".png: ", "neither PNG", "convert"));
  }
}

}  // namespace
}  // namespace foresight::image_test
