#include "apps/replay_report/contact_sheet.hpp"
#include "common/text.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "tests/replay_report/example_run.hpp"

namespace foresight::contact_sheet_test {
namespace {

const cv::Mat kGrey(30, 40, CV_8UC3, cv::Scalar(100, 100, 100));

FrameRecord frame_at(double time_s) {
  FrameRecord frame;
  frame.time_s = time_s;
  return frame;
}

cv::Mat predicted_with(int alpha, int level = 100) {
  return cv::Mat(30, 40, CV_8UC4, cv::Scalar(level, level, level, alpha));
}

TEST(ErrorPicture, TellsErrorFilledAndEmptyApart) {
  const auto pixel = [](const cv::Mat& predicted) { return error_picture(predicted, kGrey).at<cv::Vec3b>(0, 0); };
  EXPECT_EQ(pixel(predicted_with(255)), error_colour(0));
  EXPECT_EQ(pixel(predicted_with(255, 132)), error_colour(0.5));
  EXPECT_EQ(pixel(predicted_with(255, 255)), error_colour(1));
  EXPECT_EQ(pixel(predicted_with(128, 255)), kFilledColour) << "the hatch starts at the corner";
  EXPECT_EQ(pixel(predicted_with(64)), kUncolouredColour);
  EXPECT_EQ(pixel(predicted_with(0)), kNoModelColour);
  EXPECT_NE(error_colour(0), kNoModelColour);
  EXPECT_THROW(error_picture(kGrey, kGrey), std::invalid_argument);
}

TEST(Instant, ComposesOverNeutralDarkAndIsScaledDown) {
  const Instant instant = make_instant(frame_at(1), kGrey, predicted_with(0), kGrey, 20);
  EXPECT_EQ(instant.predicted.size(), cv::Size(20, 15));
  EXPECT_EQ(instant.error.size(), cv::Size(20, 15));
  EXPECT_EQ(instant.predicted.at<cv::Vec3b>(7, 7), kNoModelColour);
  EXPECT_EQ(make_instant(frame_at(1), kGrey, predicted_with(255), kGrey, 900).actual.cols, 40) << "never enlarged";
}

TEST(InstantKeeper, SpreadsOverRunsOfAnyLength) {
  for (const int frames : {1, 3, 4, 5, 8, 9, 50, 777, 3000}) {
    InstantKeeper keeper(4, 8);
    for (int i = 0; i < frames; ++i) keeper.offer(frame_at(i), kGrey, predicted_with(255), kGrey);
    const auto instants = keeper.instants();
    ASSERT_EQ(instants.size(), static_cast<std::size_t>(std::min(frames, 4)));
    for (std::size_t i = 1; i < instants.size(); ++i) {
      const double step = instants[i].frame.time_s - instants[i - 1].frame.time_s;
      EXPECT_GE(step, std::max(1, frames / 12)) << frames << " frames";
      EXPECT_LE(step, std::max(2, frames / 2)) << frames << " frames";
    }
    EXPECT_GE(instants.back().frame.time_s, (frames - 1) / 2) << "the later half is shown too";
  }
}

TEST(ContactSheet, GrowsWithItsRowsAndShowsThePictures) {
  cv::Mat delayed(30, 40, CV_8UC3, cv::Scalar(200, 0, 0));
  const std::vector<Instant> two(2, make_instant(frame_at(1), delayed, predicted_with(255), kGrey, 900));
  const cv::Mat one_row = draw_contact_sheet("title", std::span(two).first(1), 800);
  const cv::Mat two_rows = draw_contact_sheet("title", two, 800);
  EXPECT_EQ(one_row.cols, 800);
  EXPECT_GT(two_rows.rows, one_row.rows + 100);
  cv::Mat blue;
  cv::inRange(one_row, cv::Scalar(200, 0, 0), cv::Scalar(200, 0, 0), blue);
  EXPECT_GT(cv::countNonZero(blue), 150 * 100);
  EXPECT_FALSE(draw_contact_sheet("nothing", {}).empty());
}

TEST(ContactSheet, IsWrittenAsPng) {
  const auto file = std::filesystem::temp_directory_path() / ("foresight_sheet_" + std::to_string(::getpid()) + ".png");
  write_contact_sheet("title", {}, file);
  EXPECT_EQ(cv::imread(file.string()).cols, 1920);
  std::filesystem::remove(file);
}

TEST(Readable, HasADashForWhatIsNoNumber) {
  EXPECT_EQ(readable(18.449, 1, " dB"), "18.4 dB");
  EXPECT_EQ(readable(NAN, 1, " dB"), "-");
  EXPECT_EQ(readable(std::nullopt, 1), "-");
}

}  // namespace
}  // namespace foresight::contact_sheet_test
