// Screenshots are numbered, and one that fails ends nothing.
#include "seat/screenshot.hpp"

#include <gtest/gtest.h>

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

TEST(Screenshot, OneThatCannotBeWrittenSaysSo) {
  const TempFolder folder;
  const Screenshot shot = save_screenshot(folder.path() / "gone", kPicture);
  EXPECT_NE(shot.trouble.find("foresight-001.png"), std::string::npos) << shot.trouble;
}

}  // namespace
}  // namespace foresight::screenshot_test
