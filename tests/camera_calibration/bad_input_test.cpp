#include <gmock/gmock.h>

#include "calibration/camera/camera_calibration.hpp"
#include "common/error.hpp"
#include "tests/camera_calibration/synthetic_rig.hpp"

namespace foresight::bad_input_test {
namespace {

using test::synthetic_rig;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

CameraCalibration calibrate(const RigViews& views) {
  CameraCalibrationOptions options;
  options.model = Distortion::radtan4;
  return calibrate_rig(views, subset(views, {}), options);
}

std::string refusal(const RigViews& views) {
  try {
    calibrate(views);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

void reverse(std::vector<Corner>& corners) {
  for (Corner& corner : corners) corner.index = 53 - corner.index;
  std::reverse(corners.begin(), corners.end());
}

TEST(BadInput, FewViews) {
  const auto s = synthetic_rig(1, {.views = 9});
  EXPECT_THAT(refusal(subset(s.views, {0, 1, 2, 3})), HasSubstr("there are 4, and at least 5 are needed"));
  const CameraCalibration c = calibrate(s.views);
  EXPECT_TRUE(c.usable()) << c.full();
  EXPECT_THAT(c.notes, Contains(HasSubstr("only 9 pairs")));
}

TEST(BadInput, TooFewViewsForTheLensAreNotUsable) {
  const auto s = synthetic_rig(1, {.views = 30, .noise_px = 1});
  const CameraCalibration few = calibrate(subset(s.views, {0, 1, 2, 3, 4}));
  EXPECT_FALSE(few.usable());
  EXPECT_THAT(few.verdict.text(), AllOf(HasSubstr("5 pairs are too few"), HasSubstr("take 15 and more")));
  EXPECT_TRUE(calibrate(s.views).usable());
}

TEST(BadInput, ReversedBoardIsTurned) {
  auto s = synthetic_rig(2, {.views = 12});
  reverse(s.views.views[4].corners[1]);
  reverse(s.views.views[7].corners[0]);
  const CameraCalibration c = calibrate(s.views);
  EXPECT_THAT(c.repairs.turned, testing::ElementsAre("view4", "view7"));
  EXPECT_THAT(c.repairs.dropped, IsEmpty());
  EXPECT_LT(c.solution.rms_px, 0.35);
  EXPECT_THAT(c.full(), HasSubstr("turned: view view4"));
}

TEST(BadInput, SwappedCamerasAreNotUsable) {
  auto s = synthetic_rig(2, {.views = 12});
  EXPECT_TRUE(calibrate(s.views).usable());
  for (RigView& view : s.views.views) std::swap(view.corners[0], view.corners[1]);
  const CameraCalibration c = calibrate(s.views);
  EXPECT_FALSE(c.usable());
  EXPECT_THAT(c.verdict.text(),
              AllOf(HasSubstr("mm to the left of the left one"), HasSubstr("exchange left and right")));
}

TEST(BadInput, PairThatDoesNotBelongTogetherIsDropped) {
  auto s = synthetic_rig(3, {.views = 12});
  s.views.views[5].corners[1] = s.views.views[6].corners[1];
  const CameraCalibration c = calibrate(s.views);
  EXPECT_THAT(c.repairs.dropped, testing::ElementsAre(HasSubstr("view5: its two images are")));
  EXPECT_EQ(c.views.views.size(), 11u);
  EXPECT_TRUE(c.usable()) << c.full();
}

TEST(BadInput, MirroredCamera) {
  auto s = synthetic_rig(4, {.views = 10});
  auto found_anew = s.views;  // a finder numbers the corners of a mirrored image from the left again
  for (std::size_t v = 0; v < s.views.views.size(); ++v)
    for (Corner& corner : s.views.views[v].corners[1]) corner.pixel.x() = 639 - corner.pixel.x();
  EXPECT_THAT(refusal(s.views), AllOf(HasSubstr("right camera"), HasSubstr("mirrored")));
  for (RigView& view : found_anew.views) {
    for (Corner& corner : view.corners[1]) {
      corner.pixel.x() = 639 - corner.pixel.x();
      corner.index = corner.index / 9 * 9 + 8 - corner.index % 9;
    }
    std::sort(view.corners[1].begin(), view.corners[1].end(), [](auto& a, auto& b) { return a.index < b.index; });
  }
  EXPECT_THAT(refusal(found_anew), HasSubstr("one of the two cameras delivers mirrored images"));
}

TEST(BadInput, PairsShiftedByOne) {
  const auto s = synthetic_rig(5, {.views = 12});
  for (const int shift : {1, -1}) {
    RigViews shifted = s.views;
    for (int v = 0; v < 12; ++v) {
      const int other = v + shift;
      shifted.views[std::size_t(v)].corners[1] =
          other < 0 || other > 11 ? std::vector<Corner>{} : s.views.views[std::size_t(other)].corners[1];
    }
    EXPECT_THAT(refusal(shifted), HasSubstr("they are shifted by one")) << shift;
  }
}

TEST(BadInput, UnsynchronisedPairs) {
  auto s = synthetic_rig(6, {.views = 14});
  std::mt19937 random(1);
  std::normal_distribution<double> moved(0, 1.0);  // px, between the two exposures
  for (RigView& view : s.views.views) {
    const Eigen::Vector2d shift(moved(random), moved(random));
    for (Corner& corner : view.corners[1]) corner.pixel += shift;
  }
  const CameraCalibration c = calibrate(s.views);
  EXPECT_FALSE(c.usable());
  EXPECT_THAT(c.verdict.text(), HasSubstr("not synchronised"));
  EXPECT_GT(c.stereo_over_mono, 1.4);
}

TEST(BadInput, NamesTheCornerThatIsNotANumber) {
  const auto s = synthetic_rig(7, {.views = 6, .cameras = 1});
  CornerSet set{640, 480, s.views.p_board, {}};
  for (const RigView& view : s.views.views) set.views.push_back({view.name, view.corners[0]});
  set.views[2].corners[13].pixel.y() = std::nan("");
  try {
    rig_views(set);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("view2"), HasSubstr("corner 13"), HasSubstr("not a number")));
  }
}

TEST(BadInput, SizesThatDiffer) {
  auto s = synthetic_rig(8, {.views = 10});
  s.views.width[1] = 752;
  EXPECT_THAT(calibrate(s.views).notes, Contains(HasSubstr("640x480 and 752x480")));
  s.views.width[0] = 320;
  EXPECT_THAT(refusal(s.views), AllOf(HasSubstr("outside the image of 320x480"), HasSubstr("left view")));
}

TEST(BadInput, SingleCornersOutsideTheImageAreDroppedByName) {
  auto s = synthetic_rig(9, {.views = 12});
  s.views.views[2].corners[0][7].pixel = {-30, 20};
  s.views.views[6].corners[0][40].pixel = {320, 4000};
  const CameraCalibration c = calibrate(s.views);
  EXPECT_TRUE(c.usable()) << c.full();
  EXPECT_THAT(c.notes, Contains(HasSubstr("left view view2, corner 7 lies outside the image of 640x480")));
  EXPECT_THAT(c.notes, Contains(HasSubstr("left view view6, corner 40 lies outside")));
  EXPECT_THAT(c.notes, Contains("2 of 648 corners of the left camera lie outside the image and are not used"));
  EXPECT_EQ(c.views.views[2].corners[0].size(), 53u);
  EXPECT_LT(c.held_out.joint_px, 0.35);
}

TEST(BadInput, ManyCornersOutsideTheImageAreRefused) {
  auto few = synthetic_rig(9, {.views = 12});
  for (std::size_t v = 0; v < 7; ++v) few.views.views[v].corners[1][v].pixel.x() = 700;
  EXPECT_THAT(refusal(few.views), AllOf(HasSubstr("right view view0, corner 0"), HasSubstr("7 of 648 corners")));
  auto one_view = synthetic_rig(9, {.views = 12});
  for (std::size_t i = 0; i < 4; ++i) one_view.views.views[5].corners[0][i].pixel.y() = -40;
  EXPECT_THAT(refusal(one_view.views), AllOf(HasSubstr("left view view5, corner 0"), HasSubstr("4 of 648")));
}

TEST(BadInput, OneWrongCornerDoesNotChangeTheGuessedSize) {
  auto s = synthetic_rig(9, {.views = 12});
  s.views.width = s.views.height = {0, 0};
  s.views.views[3].corners[1][20].pixel = {3000, 1500};
  const CameraCalibration c = calibrate(s.views);
  EXPECT_EQ(c.views.width, (std::array{640, 640}));
  EXPECT_EQ(c.views.height, (std::array{480, 480}));
  EXPECT_THAT(c.notes, Contains(HasSubstr("the size of the images was not given; 640x480")));
  EXPECT_THAT(c.notes, Contains(HasSubstr("right view view3, corner 20 lies outside")));
}

TEST(BadInput, DifferentBoards) {
  const auto s = synthetic_rig(8, {.views = 6});
  StereoCorners pair;
  pair.left.p_board = s.views.p_board;
  pair.right.p_board = board_points(parse_board("chessboard:8x6:0.03"));
  EXPECT_THROW(rig_views(pair), InputError);
}

TEST(Rejection, TakesOutWhatWasMovedAndNamesIt) {
  auto s = synthetic_rig(10, {.views = 12});
  s.views.views[3].corners[0][17].pixel.x() += 15;
  s.views.views[8].corners[1][50].pixel.y() -= 6;
  const CameraCalibration c = calibrate(s.views);
  ASSERT_GE(c.solution.rejected.size(), 2u);
  EXPECT_EQ(c.solution.rejected[0].view, 3u);
  EXPECT_EQ(c.solution.rejected[0].index, 17);
  EXPECT_EQ(c.solution.rejected[1].camera, 1);
  EXPECT_LE(c.solution.rejected.size(), 3u);
  EXPECT_THAT(c.full(), HasSubstr("rejected: left view view3, corner 17"));
}

TEST(Rejection, TakesNothingOutOfWhatIsDrawnExactly) {
  auto s = synthetic_rig(10, {.views = 12, .noise_px = 1e-4});
  s.views.views[3].corners[0][17].pixel.x() += 0.01;
  EXPECT_THAT(calibrate(s.views).solution.rejected, IsEmpty());
}

TEST(HeldOut, InlierFiguresAreThoseOfTheViewsWithoutWrongCorners) {
  auto s = synthetic_rig(11, {.views = 12});
  const CameraCalibration clean = calibrate(s.views);
  EXPECT_LE(clean.held_out.rejected_points, 1);
  auto& views = s.views.views;
  views[3].corners[0][17].pixel.x() += 60;
  views[3].corners[0][40].pixel.y() += 9;
  views[8].corners[1][50].pixel.y() -= 12;
  const HeldOutScore score = calibrate(s.views).held_out;
  EXPECT_EQ(score.rejected_points, clean.held_out.rejected_points + 3);
  EXPECT_GT(score.joint_px, 3 * clean.held_out.joint_px);
  EXPECT_NEAR(score.joint_inlier_px, clean.held_out.joint_inlier_px, 0.01);
  EXPECT_NEAR(score.cross_inlier_px, clean.held_out.cross_inlier_px, 0.02);
  EXPECT_NEAR(score.epipolar_inlier_px, clean.held_out.epipolar_inlier_px, 0.01);
}

TEST(Rejection, NamesAViewOfAnotherLens) {
  auto s = synthetic_rig(13, {.views = 16, .cameras = 1});
  std::vector<Corner>& corners = s.views.views[6].corners[0];
  const Eigen::Vector2d middle = (corners.front().pixel + corners.back().pixel) / 2;
  const double rim = (corners.front().pixel - middle).squaredNorm();
  for (Corner& corner : corners) {
    const Eigen::Vector2d off = corner.pixel - middle;
    corner.pixel = middle + off * (1 - 0.4 * off.squaredNorm() / rim);
  }
  EXPECT_THAT(calibrate(s.views).notes, Contains(HasSubstr("most corners of view view6 do not fit")));
}

TEST(HeldOut, AViewThatIsWrongAsAWholeIsNotHidden) {
  auto s = synthetic_rig(12, {.views = 12});
  RigViews test = s.views;
  std::mt19937 random(3);
  std::normal_distribution<double> shaken(0, 6);
  for (Corner& corner : test.views[4].corners[0]) corner.pixel += Eigen::Vector2d(shaken(random), shaken(random));
  for (Corner& corner : test.views[4].corners[1]) corner.pixel += Eigen::Vector2d(shaken(random), shaken(random));
  CameraCalibrationOptions options;
  options.model = Distortion::radtan4;
  const HeldOutScore score = calibrate_rig(s.views, test, options).held_out;
  EXPECT_GT(score.joint_px, 1.5);
  EXPECT_NEAR(score.joint_inlier_px, score.joint_px, 0.1 * score.joint_px);
}

}  // namespace
}  // namespace foresight::bad_input_test
