#include "calibration/target/print_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibration/target/find_corners.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::print_board_test {
namespace {

using testing::HasSubstr;

constexpr int kDpi = 150;

class PrintedBoard : public testing::TestWithParam<const char*> {};

TEST_P(PrintedBoard, IsFoundAtTrueScale) {
  if (std::system("command -v pdftoppm >/dev/null") != 0) GTEST_SKIP() << "pdftoppm is missing (poppler-utils)";
  const Board board = parse_board(GetParam());
  const TempFolder folder;
  write_board_pdf(folder / "board.pdf", board, parse_paper("A4"));
  const std::string make = "pdftoppm -gray -r " + std::to_string(kDpi) + " '" + (folder / "board.pdf").string() +
                           "' '" + (folder / "page").string() + "'";
  ASSERT_EQ(std::system(make.c_str()), 0);
  const cv::Mat page = cv::imread((folder / "page-1.pgm").string(), cv::IMREAD_GRAYSCALE);
  ASSERT_FALSE(page.empty());
  const auto found = BoardFinder(board).find(page);
  ASSERT_TRUE(found) << GetParam();
  const auto p_board = board_points(board);
  ASSERT_EQ(found->corners.size(), p_board.size());
  // Scale and axes by least squares: pixel = A p + t.
  Eigen::MatrixXd design(p_board.size(), 3), pixels(p_board.size(), 2);
  for (std::size_t i = 0; i < p_board.size(); ++i) {
    design.row(static_cast<Eigen::Index>(i)) << p_board[i].x(), p_board[i].y(), 1;
    pixels.row(static_cast<Eigen::Index>(i)) = found->corners[i].pixel.transpose();
  }
  const Eigen::MatrixXd A = design.colPivHouseholderQr().solve(pixels);
  const double px_per_metre = kDpi / 0.0254;
  EXPECT_NEAR(A(0, 0) / px_per_metre, 1, 1e-3);
  EXPECT_NEAR(A(1, 1) / px_per_metre, 1, 1e-3);
  EXPECT_NEAR(A(0, 1) / px_per_metre, 0, 1e-3);
  EXPECT_NEAR(A(1, 0) / px_per_metre, 0, 1e-3);
  EXPECT_LT((design * A - pixels).rowwise().norm().maxCoeff(), 0.6);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PrintedBoard,
                         testing::Values("chessboard:9x6:0.023", "charuco:6x4:0.03:0.022:DICT_4X4_50",
                                         "charuco:8x5:0.03:0.022:DICT_5X5_100", "charuco:5x7:0.03:0.02:DICT_6X6_250",
                                         "apriltag:4x3:0.042:0.0126", "circles:9x6:0.025"));

TEST(PrintBoard, TooLargeNamesWhatFits) {
  const TempFolder folder;
  const auto large = [&](const char* board) {
    return input_error([&] { write_board_pdf(folder / "b.pdf", parse_board(board), parse_paper("A4")); });
  };
  const std::string text = large("chessboard:9x6:0.05");
  EXPECT_THAT(text, AllOf(HasSubstr("A4 leaves"), HasSubstr("chessboard:9x6:0.02")));
  // What is named does fit.
  const std::size_t at = text.find("chessboard:9x6:0.02");
  EXPECT_EQ(large(text.substr(at, text.find_first_not_of("chesboard:9x60.12345678", at) - at).c_str()), "no error");
  EXPECT_THAT(large("charuco:5x7:0.03"), HasSubstr("charuco:5x7:0.03:0.021:DICT_5X5_1000"));
  EXPECT_THAT(input_error([] { parse_paper("A5x"); }), HasSubstr("is no paper"));
  EXPECT_THAT(input_error([&] {
                write_board_pdf(folder / "small.pdf", parse_board("chessboard:3x4:0.008"), parse_paper("150x120"));
              }),
              AllOf(HasSubstr("--paper"), HasSubstr("both rulers")));
  EXPECT_FALSE(std::filesystem::exists(folder / "small.pdf"));
  EXPECT_EQ(parse_paper("600x400_mm").height_mm, 600);
}

TEST(PrintBoard, MoreColumnsThanAnImageShowsAreRefusedAsSuch) {
  for (const char* board : {"chessboard:9999x6:0.001", "circles:6x1001:0.001"})
    EXPECT_THAT(input_error([&] { parse_board(board); }), HasSubstr("more than 1000 cannot be told apart in an image"));
  EXPECT_THAT(input_error([] { parse_board("chessboard:2x6:0.02"); }), Not(HasSubstr("1000")));
  EXPECT_EQ(parse_board("circles:6x1000:0.001").rows, 1000);
}

TEST(PrintBoard, MeasuredScale) {
  const Board board = parse_board("apriltag:4x3:0.045:0.0135");
  const Board printed = measured_board(board, 99.0, 99.2);
  EXPECT_NEAR(printed.size_m, 0.045 * 0.991, 1e-12);
  EXPECT_NEAR(printed.gap_m, 0.0135 * 0.991, 1e-12);
  EXPECT_THAT(input_error([&] { measured_board(board, 100, 99.3); }), HasSubstr("99.30 %"));
  EXPECT_THAT(input_error([&] { measured_board(board, 10.0, 9.93); }), HasSubstr("ruler"));
}

}  // namespace
}  // namespace foresight::print_board_test
