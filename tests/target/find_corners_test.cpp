#include "calibration/target/find_corners.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/target/corner_files.hpp"
#include "calibration/target/refine_grid.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/target/drawn_board.hpp"

namespace foresight::find_corners_test {
namespace {

const std::filesystem::path kOpenCvPictures = "/usr/share/doc/opencv-doc/examples/data";

/// Of all threads.
double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double worst_error(const FoundBoard& found, const DrawnView& view) {
  double worst = 0;
  for (const Corner& corner : found.corners)
    worst = std::max(worst, (corner.pixel - view.pixels[static_cast<std::size_t>(corner.index)]).norm());
  return worst;
}

Eigen::Vector2d mean_error(const FoundBoard& found, const DrawnView& view) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Corner& corner : found.corners) sum += corner.pixel - view.pixels[static_cast<std::size_t>(corner.index)];
  return sum / static_cast<double>(found.corners.size());
}

class EveryBoard : public testing::TestWithParam<const char*> {};

TEST_P(EveryBoard, IsFoundWhereItWasDrawn) {
  const Board board = parse_board(GetParam());
  BoardFinder finder(board);
  for (const DrawnView& view : {draw_board(board, 640, 480, 10, 0), draw_board(board, 640, 480, -25, 20)}) {
    const auto found = finder.find(view.grey);
    ASSERT_TRUE(found) << GetParam();
    EXPECT_EQ(found->corners.size(), view.pixels.size());
    EXPECT_FALSE(found->partial);
    EXPECT_LT(worst_error(*found, view), board.kind == BoardKind::apriltag ? 0.35 : 0.15) << GetParam();
    EXPECT_LT(mean_error(*found, view).norm(), 0.06) << GetParam();  // another pixel convention would be 0.5
    for (const Corner& corner : found->corners) EXPECT_GT(corner.sigma_px, 0);
    EXPECT_GT(found->quality.sharpness, 0.2);
    EXPECT_NEAR(found->quality.coverage, view.coverage, 0.02);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryBoard,
                         testing::Values("chessboard:9x6:0.025", "chessboard:7x7:0.025", "chessboard:8x6:0.025",
                                         "charuco:7x5:0.03:0.02:DICT_5X5_100", "apriltag:4x3:0.05:0.015",
                                         "apriltag:4x3:0.05:0.015:tag36h11b2", "circles:7x5:0.03"));

TEST(FindCorners, LargeImagesAreReducedToFindAndNotToRefine) {
  const Board board = parse_board("chessboard:24x17:0.02");
  const DrawnView view = draw_board(board, 1920, 1200, 12, 25);
  const auto found = BoardFinder(board).find(view.grey);
  ASSERT_TRUE(found);
  EXPECT_LT(worst_error(*found, view), 0.15);
}

// As OpenCV guesses them where it did not find the squares of a rim.
TEST(RefineGrid, MendsGuessesSideBySide) {
  const Board board = parse_board("chessboard:9x6:0.025");
  const DrawnView view = draw_board(board, 320, 240, 4, 30);
  GridPoints rough;
  for (const Eigen::Vector2d& p : view.pixels) rough.emplace_back(float(p.x()), float(p.y()));
  const float spacing = neighbour_spacing(rough, 9, 6)[0];
  const std::array<cv::Point2f, 3> guesses{{{0.14f, 0.23f}, {-0.13f, 0.18f}, {0.16f, 0.20f}}};  // of the spacing
  for (std::size_t i = 0; i < guesses.size(); ++i) rough[i] += 1.2f * spacing * guesses[i];
  const auto corners = refine_grid(view.grey, rough, 9, 6);
  for (std::size_t i = 0; i < corners.size(); ++i)
    EXPECT_LT(std::hypot(corners[i].at.x - view.pixels[i].x(), corners[i].at.y - view.pixels[i].y()), 0.2) << i;
}

// Close up, with a wide lens, a square may be larger by half than the one beside it.
TEST(RefineGrid, LeavesCornersOfCloseViewsWhereTheyAre) {
  const Board board = parse_board("chessboard:3x9:0.025");
  Pose T_camera_board = Pose::Identity();
  T_camera_board.translate(Eigen::Vector3d(0, 0, 0.14));
  T_camera_board.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 0.1, 0).normalized()));
  T_camera_board.translate(Eigen::Vector3d(-0.025, -0.1, 0));
  const DrawnView view = draw_board_at(board, 300, 900, T_camera_board);
  GridPoints rough;
  for (const Eigen::Vector2d& p : view.pixels) rough.emplace_back(float(p.x()), float(p.y()));
  const auto corners = refine_grid(view.grey, rough, 3, 9);
  for (std::size_t i = 0; i < corners.size(); ++i)
    EXPECT_LT(std::hypot(corners[i].at.x - view.pixels[i].x(), corners[i].at.y - view.pixels[i].y()), 0.3) << i;
}

TEST(FindCorners, TiltAndTurnSayHowTheBoardLies) {
  const Board board = parse_board("chessboard:9x6:0.025");
  BoardFinder finder(board);
  const auto flat = finder.find(draw_board(board, 640, 480, 0, 0).grey);
  const auto tilted = finder.find(draw_board(board, 640, 480, 0, 30).grey);
  ASSERT_TRUE(flat && tilted);
  EXPECT_LT(flat->quality.tilt_deg, 3);
  EXPECT_NEAR(tilted->quality.tilt_deg, 30, 5);
  EXPECT_NEAR(tilted->quality.turn_deg, 0, 10);  // draw_board moves the right side away
}

TEST(FindCorners, BlurLowersSharpnessAndRaisesNoise) {
  const Board board = parse_board("chessboard:9x6:0.025");
  BoardFinder finder(board);
  const DrawnView view = draw_board(board, 640, 480, 5, 10);
  cv::Mat blurred;
  cv::blur(view.grey, blurred, {1, 9});  // along one direction, as motion does
  const auto sharp = finder.find(view.grey), soft = finder.find(blurred);
  ASSERT_TRUE(sharp && soft);
  EXPECT_LT(soft->quality.sharpness, 0.6 * sharp->quality.sharpness);
  EXPECT_GT(soft->corners[20].sigma_px, sharp->corners[20].sigma_px);
}

TEST(FindCorners, PartOfABoardOnlyWithIds) {
  for (const char* text : {"chessboard:9x6:0.025", "charuco:7x5:0.03:0.02:DICT_5X5_100", "apriltag:4x3:0.05:0.015"}) {
    const Board board = parse_board(text);
    DrawnView view = draw_board(board, 640, 480, 0, 0);
    view.grey.colRange(0, 200).setTo(128);
    const auto found = BoardFinder(board).find(view.grey);
    EXPECT_EQ(found.has_value(), board.kind != BoardKind::chessboard) << text;
    if (!found) continue;
    EXPECT_TRUE(found->partial);
    EXPECT_LT(worst_error(*found, view), 0.4);
  }
}

TEST(FindCorners, TagRowsCountedFromBelowComeInBoardOrder) {
  const Board board = parse_board("apriltag:4x3:0.05:0.015");
  const DrawnView view = draw_board(board, 640, 480, 10, 10, TagRows::from_below);
  const auto found = BoardFinder(board).find(view.grey);
  ASSERT_TRUE(found);
  EXPECT_LT(worst_error(*found, view), 0.4);
}

TEST(FindCorners, SaysWhatFits) {
  const auto drawn = [](const char* text) { return draw_board(parse_board(text), 640, 480, 5, 10).grey; };
  using testing::HasSubstr;
  EXPECT_THAT(explain_nothing_found(parse_board("chessboard:10x7:0.025"), {drawn("chessboard:9x6:0.025")}),
              AllOf(HasSubstr("10x7 not found"), HasSubstr("chessboard:9x6:0.025")));
  EXPECT_THAT(explain_nothing_found(parse_board("apriltag:4x3:0.05:0.015"), {drawn("apriltag:4x3:0.05:0.015:tag25h9")}),
              AllOf(HasSubstr("0 tags of tag36h11"), HasSubstr("tag25h9 fits")));
  EXPECT_THAT(
      explain_nothing_found(parse_board("apriltag:4x3:0.05:0.015"), {drawn("apriltag:4x3:0.05:0.015:tag36h11b2")}),
      HasSubstr("tag36h11b2 fits"));
  EXPECT_THAT(explain_nothing_found(parse_board("chessboard:10x7:0.025"), {drawn("chessboard:9x6:0.025")}),
              HasSubstr("10x7 counts its squares"));
  EXPECT_THAT(explain_nothing_found(parse_board("charuco:7x5:0.03:0.02:DICT_6X6_250"),
                                    {drawn("charuco:7x5:0.03:0.02:DICT_5X5_100")}),
              HasSubstr("DICT_5X5_50 fits"));
  EXPECT_THAT(explain_nothing_found(parse_board("circles:8x6:0.03"), {drawn("circles:7x5:0.03")}),
              HasSubstr("7x5 were"));
  cv::Mat mirrored;
  cv::flip(drawn("apriltag:4x3:0.05:0.015"), mirrored, 1);
  EXPECT_THAT(explain_nothing_found(parse_board("apriltag:4x3:0.05:0.015"), {mirrored}), HasSubstr("mirrored"));
}

// The finder by quads alone takes ten seconds.
TEST(FindCorners, NoiseCostsLittle) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG random(1);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  const double before = cpu_seconds();
  EXPECT_FALSE(BoardFinder(parse_board("chessboard:9x6:0.025")).find(noise));
  EXPECT_LT(cpu_seconds() - before, 3);
}

TEST(FindCorners, SaysWhichTagsAndBoardsThereAre) {
  EXPECT_THAT(input_error([] { BoardFinder(parse_board("apriltag:30x30:0.05")); }),
              AllOf(testing::HasSubstr("tag36h11 has 587 tags, the board 900"),
                    testing::Not(testing::HasSubstr("such as tag36h11;"))));
  for (const char* board : {"checker:9x6:0.025", "CHESSBOARD:9x6:0.025", "checkerboard:9x6:0.025"})
    EXPECT_THAT(input_error([&] { parse_board(board); }),
                AllOf(testing::HasSubstr("kinds are chessboard, charuco, apriltag, circles"),
                      testing::HasSubstr("such as chessboard:9x6:0.025")));
}

TEST(FindCorners, RefusesUnknownFamilies) {
  EXPECT_THROW(BoardFinder(parse_board("apriltag:4x3:0.05:0.015:tag36h12")), InputError);
  EXPECT_THROW(BoardFinder(parse_board("apriltag:6x6:0.05:0.015:tag25h9")), InputError);
  EXPECT_THROW(BoardFinder(parse_board("charuco:7x5:0.03:0.02:DICT_6x6")), InputError);
}

TEST(FindCorners, AlignsAmbiguousOrders) {
  const Board board = parse_board("chessboard:7x7:0.025");
  BoardFinder finder(board);
  const auto left = finder.find(draw_board(board, 640, 480, 88, 10).grey);
  auto right = finder.find(draw_board(board, 640, 480, 92, 10).grey);
  ASSERT_TRUE(left && right);
  align_order(board, *left, *right);
  for (std::size_t i = 0; i < 49; ++i) EXPECT_LT((left->corners[i].pixel - right->corners[i].pixel).norm(), 20);
}

TEST(FindCornersData, OpenCvPicturesAsTheFrozenCorners) {
  FORESIGHT_NEED_DATA("opencv_stereo_corners");
  if (!std::filesystem::exists(kOpenCvPictures / "left01.jpg")) GTEST_SKIP() << "opencv-doc is not installed";
  const Board board = parse_board("chessboard:9x6:1");
  const StereoCorners frozen = read_stereo_corners(data_folder() / "opencv_stereo_corners/corners_pc25.vnl", board);
  BoardFinder finder(board);
  double sum = 0, worst = 0;
  for (const auto& [set, side] : {std::pair{&frozen.left, "left"}, {&frozen.right, "right"}})
    for (const BoardView& view : set->views) {
      const auto found =
          finder.find(cv::imread((kOpenCvPictures / (side + view.name + ".jpg")).string(), cv::IMREAD_GRAYSCALE));
      ASSERT_TRUE(found) << side << view.name;
      EXPECT_FALSE(found->ambiguous);
      for (std::size_t i = 0; i < 54; ++i) {
        const double error = (found->corners[i].pixel - view.corners[i].pixel).norm();
        sum += error / (26 * 54);
        worst = std::max(worst, error);
      }
    }
  EXPECT_LT(sum, 0.005);
  EXPECT_LT(worst, 0.08);
}

std::vector<cv::Mat> pictures(const std::filesystem::path& folder) {
  std::vector<cv::Mat> greys;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    greys.push_back(cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE));
  return greys;
}

TEST(FindCornersData, CirclesWithABigDotStartAtIt) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  BoardFinder finder(parse_board("circles:10x10:0.0254"));
  const auto greys = pictures(data_folder() / "rct_arm_handeye/test_set_10x10/images");
  EXPECT_EQ(greys.size(), 15u);
  for (const cv::Mat& grey : greys) {
    const auto found = finder.find(grey);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->ambiguous);
    EXPECT_EQ(found->corners.size(), 100u);
  }
}

TEST(FindCornersData, CharucoDictionaryAndMarkersFromImages) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  const auto greys = pictures(data_folder() / "rct_arm_handeye/test_set_charuco/images");
  const Board board = complete_board(parse_board("charuco:5x7:0.036195"), {greys[0], greys[1]});
  EXPECT_EQ(board.family, "DICT_6X6_50");  // the beginning of DICT_6X6_250
  EXPECT_NEAR(board.marker_m, 0.018256, 0.0006);
  BoardFinder finder(board);
  std::size_t corners = 0;
  for (const cv::Mat& grey : greys) {
    const auto found = finder.find(grey);
    ASSERT_TRUE(found);
    corners += found->corners.size();
  }
  EXPECT_GE(corners, 9u * 21);
}

}  // namespace
}  // namespace foresight::find_corners_test
