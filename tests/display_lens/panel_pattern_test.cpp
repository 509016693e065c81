#include "calibration/display_lens/panel_pattern.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/display_lens/simulated_display.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::panel_pattern_test {
namespace {

using testing::HasSubstr;

TEST(PanelPattern, CornersAreWhereTheSquaresMeet) {
  const PanelPattern pattern = parse_pattern("640x480:9x6:40");
  const cv::Mat image = draw_pattern(pattern);
  ASSERT_EQ(image.size(), cv::Size(640, 480));
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 9; ++col) {
      const Eigen::Vector2d at = pattern.corner(col, row);
      const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
      EXPECT_EQ(image.at<uchar>(y, x), image.at<uchar>(y + 1, x + 1));
      EXPECT_NE(image.at<uchar>(y, x), image.at<uchar>(y, x + 1));
      EXPECT_EQ(image.at<uchar>(y + 1, x), image.at<uchar>(y, x + 1));
    }
}

TEST(PanelPattern, IsFoundInWhatTheEyeCameraTakes) {
  SimulatedDisplay display;
  display.pattern = parse_pattern("1440x1600:9x8:88");
  display.T_display_camera.resize(1);
  const auto found = find_pattern(display.pattern, picture_of(display, draw_pattern(display.pattern), 0), 0);
  const auto truth = display.points(0, 1);
  ASSERT_EQ(found.size(), truth.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].panel_pixel, truth[i].panel_pixel);
    EXPECT_LT((found[i].camera_pixel - truth[i].camera_pixel).norm(), 0.15);
    mean += (found[i].camera_pixel - truth[i].camera_pixel) / static_cast<double>(found.size());
  }
  EXPECT_LT(mean.norm(), 0.03) << mean.transpose();
  EXPECT_TRUE(find_pattern(display.pattern, cv::Mat(400, 400, CV_8U, cv::Scalar(90)), 0).empty());
}

TEST(PanelPattern, NamesWhatIsWrong) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parse_pattern(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("1440x1600"), HasSubstr("1440x1600:9x8:120"));
  EXPECT_THAT(refusal("1440:9x8:120"), HasSubstr("'1440'"));
  EXPECT_THAT(refusal("640x480:9x8:120"), HasSubstr("at most 53 px"));
  EXPECT_THAT(refusal("1440x1600:8x6:120"), HasSubstr("upside down"));
  EXPECT_THAT(refusal("1440x1600:9x8:big"), HasSubstr("no square"));
}

TEST(PanelPattern, ReadsPoints) {
  const TempFolder folder;
  const auto points = read_panel_points(folder.write("p.txt", "# picture u v panel_u panel_v\n1 2 3 4 5\n"));
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].picture, 1);
  EXPECT_EQ(points[0].panel_pixel, Eigen::Vector2d(4, 5));
  EXPECT_THROW(read_panel_points(folder.write("q.txt", "-1 2 3 4 5\n")), InputError);
  EXPECT_THROW(read_panel_points(folder.write("r.txt", "1 2 3 x 5\n")), InputError);
}

}  // namespace
}  // namespace foresight::panel_pattern_test
