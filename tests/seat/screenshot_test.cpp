// Screenshots are numbered, and one that fails ends nothing.
#include "seat/screenshot.hpp"

#include <gtest/gtest.h>

#include "pictures/picture_file.hpp"
#include "tests/support/folders.hpp"

namespace foresight::screenshot_test {
namespace {

const cv::Mat kPicture(4, 6, CV_8UC3, cv::Scalar(1, 2, 3));

TEST(Screenshot, EachHasAFileOfItsOwn) {
  const TempFolder folder;
  folder.write("foresight-002.png", "somebody's");
  for (const char* name : {"foresight-001.png", "foresight-003.png", "foresight-004.png"}) {
    const Screenshot shot = save_screenshot(folder.path(), kPicture);
    EXPECT_EQ(shot.trouble, "");
    EXPECT_EQ(shot.file, folder.path() / name);
    EXPECT_EQ(folder.read(name).substr(1, 3), "PNG");
  }
  EXPECT_EQ(folder.read("foresight-002.png"), "somebody's");
}

TEST(Screenshot, NothingOfOneThatFailsIsLeft) {
  const TempFolder folder;
  EXPECT_NE(save_screenshot(folder.path(), cv::Mat(2, 2, CV_32F)).trouble, "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ScreenshotWriter, WritesAllThatItTookInTheirOrderAndUpright) {
  const TempFolder folder;
  cv::Mat rows_from_below(2, 1, CV_8UC3, cv::Scalar(0, 0, 0));
  rows_from_below.at<cv::Vec3b>(1, 0) = {10, 20, 30};
  {
    ScreenshotWriter writer(folder.path());
    EXPECT_FALSE(writer.done());
    EXPECT_TRUE(writer.take(rows_from_below));
    writer.finish();
    const auto first = writer.done();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->file, folder.path() / "foresight-001.png");
    EXPECT_EQ(first->trouble, "");
    EXPECT_FALSE(writer.done());
    EXPECT_TRUE(writer.take(rows_from_below.clone()));
  }
  EXPECT_EQ(folder.read("foresight-002.png").substr(1, 3), "PNG") << "whoever ends waits for it";
  const cv::Mat picture = read_picture(folder.path() / "foresight-001.png", PictureColours::colour);
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
}

TEST(ScreenshotWriter, TellsWhatFailedAndGoesOn) {
  const TempFolder folder;
  ScreenshotWriter writer(folder.path() / "later");
  EXPECT_TRUE(writer.take(kPicture.clone()));
  writer.finish();
  EXPECT_NE(writer.done().value().trouble.find("foresight-001.png"), std::string::npos);
  std::filesystem::create_directory(folder.path() / "later");
  EXPECT_TRUE(writer.take(kPicture.clone()));
  writer.finish();
  EXPECT_EQ(writer.done().value().trouble, "");
}

// Noise takes a coder as long as a slow disk takes for what a window shows.
TEST(ScreenshotWriter, NobodyWaitsForADisk) {
  const TempFolder folder;
  cv::Mat noise(2000, 2000, CV_8UC3);
  cv::randu(noise, 0, 256);
  ScreenshotWriter writer(folder.path());
  const auto begin = std::chrono::steady_clock::now();
  std::size_t taken = 0;
  while (taken < 20 && writer.take(noise)) ++taken;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(100));
  EXPECT_FALSE(writer.done());
  EXPECT_GE(taken, ScreenshotWriter::kRoom);
  EXPECT_LE(taken, ScreenshotWriter::kRoom + 1) << "and memory has an end";
}

TEST(Screenshot, OneThatCannotBeWrittenSaysSo) {
  const TempFolder folder;
  const Screenshot shot = save_screenshot(folder.path() / "gone", kPicture);
  EXPECT_NE(shot.trouble.find("foresight-001.png"), std::string::npos) << shot.trouble;
}

}  // namespace
}  // namespace foresight::screenshot_test
