#include "calibration/target/image_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/target/corner_files.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/target/drawn_board.hpp"

namespace foresight::image_input_test {
namespace {

using testing::HasSubstr;

class ImageInput : public testing::Test {
 protected:
  void save(const std::string& name, const cv::Mat& image) {
    std::filesystem::create_directories((files_ / name).parent_path());
    cv::imwrite((files_ / name).string(), image);
  }
  cv::Mat view(double roll, double tilt = 10) { return draw_board(board_, 320, 240, roll, tilt).grey; }

  TempFolder files_;
  const Board board_ = parse_board("chessboard:7x5:0.03");
};

TEST_F(ImageInput, DropsByNameAndReason) {
  for (int i = 0; i < 4; ++i) save("v" + std::to_string(i) + ".png", view(5 * i));
  cv::Mat blurred;
  cv::blur(view(3), blurred, {7, 1});
  save("v10.png", blurred);
  save("v9.png", cv::Mat(240, 320, CV_8U, cv::Scalar(90)));
  files_.write("notes.txt", "no image");
  const FoundCorners found = find_in_folder(files_.path(), board_);
  EXPECT_EQ(found.corners.width, 320);
  ASSERT_EQ(found.corners.views.size(), 4u);
  EXPECT_EQ(found.corners.views[3].name, "v3");
  ASSERT_EQ(found.dropped.size(), 2u);
  EXPECT_EQ(found.dropped[0].name, "v9.png");
  EXPECT_EQ(found.dropped[1].name, "v10.png");
  EXPECT_THAT(found.dropped[1].reason, HasSubstr("blurred: sharpness 0."));
}

TEST_F(ImageInput, RefusesWithNames) {
  EXPECT_THAT(input_error([&] { find_in_folder(files_ / "none", board_); }), HasSubstr("is no folder"));
  EXPECT_THAT(input_error([&] { find_in_folder(files_.path(), board_); }), HasSubstr("holds no image"));
  EXPECT_THAT(input_error([&] { find_in_folder(files_ / "left*.png", board_); }), HasSubstr("names no image"));
  save("a.png", view(0));
  save("b.png", draw_board(board_, 400, 300, 0, 0).grey);
  EXPECT_THAT(input_error([&] { find_in_folder(files_.path(), board_); }),
              AllOf(HasSubstr("b.png"), HasSubstr("400x300"), HasSubstr("a.png is 320x240")));
  files_.write("b.png", "not a picture");
  EXPECT_THAT(input_error([&] { find_in_folder(files_.path(), board_); }), HasSubstr("b.png"));
  std::filesystem::remove(files_ / "b.png");
  EXPECT_THAT(input_error([&] { find_in_folder(files_.path(), parse_board("chessboard:8x6:0.03")); }),
              AllOf(HasSubstr("8x6 not found"), HasSubstr("chessboard:7x5:0.03")));
}

TEST_F(ImageInput, PairsByNameAndBySorting) {
  for (int i = 8; i < 11; ++i) {
    save("set/left" + std::to_string(i) + ".png", view(i));
    save("set/right" + std::to_string(i) + ".png", view(i + 2));
  }
  save("set/left11.png", view(0));
  const auto found = find_pairs_in_folders(files_ / "set/left*.png", files_ / "set/right*.png", board_);
  ASSERT_EQ(found.corners.left.views.size(), 4u);
  ASSERT_EQ(found.corners.right.views.size(), 3u);
  EXPECT_EQ(found.corners.right.views[2].name, "10");
  EXPECT_EQ(found.corners.left.views[2].name, "10");
  ASSERT_EQ(found.dropped.size(), 1u);
  EXPECT_THAT(found.dropped[0].reason, HasSubstr("no right image"));

  save("l/a.png", view(0));
  save("r/b.png", view(0));
  const auto sorted = find_pairs_in_folders(files_ / "l", files_ / "r", board_);
  EXPECT_EQ(sorted.corners.left.views[0].name, sorted.corners.right.views[0].name);
  save("r/c.png", view(0));
  EXPECT_THAT(input_error([&] { find_pairs_in_folders(files_ / "l", files_ / "r", board_); }),
              HasSubstr("1 image beside 2"));
}

TEST(ImageInputData, OpenCvStereoPictures) {
  const std::filesystem::path pictures = "/usr/share/doc/opencv-doc/examples/data";
  if (!std::filesystem::exists(pictures / "left01.jpg")) GTEST_SKIP() << "opencv-doc is not installed";
  const auto found = find_pairs_in_folders(pictures / "left[01]?.jpg", pictures / "right[01]?.jpg",
                                           parse_board("chessboard:9x6:0.025"));
  EXPECT_EQ(found.corners.left.views.size(), 13u);
  EXPECT_EQ(found.corners.right.views.size(), 13u);
  EXPECT_TRUE(found.dropped.empty()) << found.dropped[0].name << ' ' << found.dropped[0].reason;
}

TEST(ImageInputData, NothingIsDroppedFromGoodSets) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  const auto sets = data_folder() / "rct_arm_handeye";
  const auto circles = find_in_folder(sets / "test_set_10x10/images", parse_board("circles:10x10:0.0254"));
  EXPECT_EQ(circles.corners.views.size(), 15u);
  EXPECT_EQ(circles.corners.views[9].name, "9");  // by number
  const auto charuco =
      find_in_folder(sets / "test_set_charuco/images", parse_board("charuco:5x7:0.036195:0.018256:DICT_6X6_250"));
  EXPECT_EQ(charuco.corners.views.size(), 9u);
}

}  // namespace
}  // namespace foresight::image_input_test
