#include "calibration/photometric/exposure_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "common/error.hpp"
#include "tests/photometric/synthetic_camera.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::exposure_series_test {
namespace {

using testing::HasSubstr;

template <typename Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A JPEG whose EXIF data say 1/125 s, in big or little byte order.
std::string with_exposure(bool little) {
  const auto number = [little](std::uint32_t value, int size) {
    std::string out;
    for (int i = 0; i < size; ++i) out += static_cast<char>(value >> (8 * (little ? i : size - 1 - i)) & 255);
    return out;
  };
  const std::string tiff = std::string(little ? "II" : "MM") + number(42, 2) + number(8, 4) +  // header
                           number(1, 2) + number(0x8769, 2) + number(4, 2) + number(1, 4) + number(26, 4) +
                           number(0, 4) +  // one entry: the EXIF directory at 26
                           number(1, 2) + number(0x829a, 2) + number(5, 2) + number(1, 4) + number(44, 4) +
                           number(0, 4) +  // one entry: ExposureTime at 44
                           number(1, 4) + number(125, 4);
  const std::string segment = std::string("Exif\0\0", 6) + tiff;
  std::vector<uchar> jpeg;
  cv::imencode(".jpg", cv::Mat(8, 8, CV_8U, cv::Scalar(90)), jpeg);
  const std::size_t length = segment.size() + 2;
  return std::string(jpeg.begin(), jpeg.begin() + 2) + "\xff\xe1" + static_cast<char>(length >> 8) +
         static_cast<char>(length & 255) + segment + std::string(jpeg.begin() + 2, jpeg.end());
}

TEST(ExposureSeries, ReadsExif) {
  const TempFolder folder;
  EXPECT_EQ(exif_exposure(folder.write("a.jpg", with_exposure(false))), 1 / 125.0);
  EXPECT_EQ(exif_exposure(folder.write("b.jpg", with_exposure(true))), 1 / 125.0);
  EXPECT_EQ(read_series(folder.path(), {}).at(1).exposure_s, 1 / 125.0);
  const std::string whole = with_exposure(true);
  for (std::size_t cut = 0; cut < 110; ++cut) exif_exposure(folder.write("cut.jpg", whole.substr(0, cut)));
  for (std::size_t at = 6; at < 90; ++at) {
    std::string damaged = whole;
    damaged[at] = '\xff';
    exif_exposure(folder.write("cut.jpg", damaged));
  }
}

TEST(ExposureSeries, ReadsExposureFiles) {
  const TempFolder folder;
  const auto exposures = read_exposures(folder.write("e.txt", "# name seconds\na.png 0.008\nb.png 1/60\n"));
  EXPECT_EQ(exposures.at("a.png"), 0.008);
  EXPECT_EQ(exposures.at("b.png"), 1 / 60.0);
  EXPECT_THAT(refusal([&] { read_exposures(folder.write("e.txt", "a.png fast\n")); }), HasSubstr("e.txt:1"));
  EXPECT_THAT(refusal([&] { read_exposures(folder.write("e.txt", "a.png -1\n")); }), HasSubstr("1/125"));
  EXPECT_THAT(refusal([&] { read_exposures(folder.write("e.txt", "a.png 1\na.png 2\n")); }), HasSubstr("twice"));
}

TEST(ExposureSeries, SaysWhatIsWrongWithAFolder) {
  const TempFolder folder;
  EXPECT_THAT(refusal([&] { read_series(folder.path(), {}); }), HasSubstr("no images"));
  cv::imwrite((folder / "image1.png").string(), cv::Mat(8, 8, CV_8U, cv::Scalar(90)));
  EXPECT_THAT(refusal([&] { read_series(folder.path(), {}); }), HasSubstr("--exposures"));
  EXPECT_THAT(refusal([&] { read_series(folder.path(), {{"image2.png", 1}, {"x", 2}}); }), HasSubstr("'image2.png'"));
  cv::imwrite((folder / "image2.png").string(), cv::Mat(8, 9, CV_8U, cv::Scalar(90)));
  EXPECT_THAT(refusal([&] {
                read_series(folder.path(), {{"image1.png", 1}, {"image2.png", 2}});
              }),
              HasSubstr("differs in size"));
}

TEST(ExposureSeries, BlocksThatSaturateAreDropped) {
  SeriesSamples samples;
  add_flat(series_of({}, cv::Mat(48, 64, CV_64F, cv::Scalar(1)), {0.2, 50}, 1), {31.5, 23.5}, samples);
  EXPECT_GT(samples.saturated, 0);
  for (const LevelSample& s : samples.samples) EXPECT_EQ(s.image, 0);
}

}  // namespace
}  // namespace foresight::exposure_series_test
