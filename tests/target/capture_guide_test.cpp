#include "calibration/target/capture_guide.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "calibration/target/capture_session.hpp"
#include "calibration/target/image_input.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::capture_guide_test {
namespace {

using testing::HasSubstr;

const Board kBoard = parse_board("chessboard:9x6:0.025");
const cv::Size kSize(640, 480);

/// A view through a pinhole of 640 px: the board's middle at (u, v), `tilt` away towards `turn`.
FoundBoard view(double u, double v, double distance, double tilt_deg = 0, double turn_deg = 0) {
  FoundBoard found;
  const Eigen::Vector3d axis(std::sin(turn_deg * CV_PI / 180), -std::cos(turn_deg * CV_PI / 180), 0);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(tilt_deg * CV_PI / 180, axis).toRotationMatrix();
  const Eigen::Vector3d at((u - 319.5) / 640 * distance, (v - 239.5) / 640 * distance, distance);
  const auto points = board_points(kBoard);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = R * (points[i] - Eigen::Vector3d(0.1, 0.0625, 0)) + at;
    found.corners.push_back({static_cast<int>(i), {640 * p.x() / p.z() + 319.5, 640 * p.y() / p.z() + 239.5}, 0.1});
  }
  found.quality = {0.8, tilt_deg, turn_deg, 0.03 / (distance * distance)};
  return found;
}

/// Shown until it stands still.
CaptureGuide::Verdict show(CaptureGuide& guide, const FoundBoard& found) {
  guide.offer(found);
  return guide.offer(found);
}

TEST(CaptureGuide, SaysWhyAFrameIsNotTaken) {
  CaptureGuide guide(kBoard, kSize);
  EXPECT_EQ(guide.offer(std::nullopt).reason, "no board");
  EXPECT_EQ(guide.offer(view(320, 240, 0.5)).reason, "hold it still");
  EXPECT_THAT(guide.offer(view(325, 240, 0.5)).reason, HasSubstr("moved by 5.0 px"));
  EXPECT_TRUE(guide.offer(view(325, 240, 0.5)).taken);
  EXPECT_EQ(guide.offer(view(326, 240, 0.5)).reason, "too like view 1");
  FoundBoard blurred = view(200, 240, 0.5);
  blurred.quality.sharpness = 0.3;
  EXPECT_THAT(show(guide, blurred).reason, HasSubstr("blurred: sharpness 0.30"));
  FoundBoard part = view(200, 240, 0.5);
  part.corners.resize(10);
  EXPECT_EQ(show(guide, part).reason, "partly seen: 10 of 54 points");
  EXPECT_EQ(guide.views(), 1);
}

TEST(CaptureGuide, AtOnceTakesWhateverShowsTheBoard) {
  CaptureGuide guide(kBoard, kSize, true);
  const FoundBoard left = view(320, 240, 0.5), right = view(280, 240, 0.5);
  EXPECT_EQ(guide.offer(left, std::nullopt, true).reason, "no board (right)");
  EXPECT_TRUE(guide.offer(left, right, true).taken);
  EXPECT_TRUE(guide.offer(left, right, true).taken) << "though it is alike";
  EXPECT_EQ(guide.views(), 2);
}

TEST(CaptureGuide, ProgressSaysWhatIsThere) {
  CaptureGuide guide(kBoard, kSize);
  EXPECT_EQ(guide.progress().wish.kind, CaptureWish::Kind::first);
  show(guide, view(320, 240, 0.5, 30, 90));
  const CaptureProgress progress = guide.progress();
  EXPECT_EQ(progress.views, 1);
  EXPECT_EQ(progress.tilted, (std::array<bool, 4>{false, true, false, false}));
  EXPECT_EQ(progress.wish.kind, CaptureWish::Kind::tilt);
  EXPECT_EQ(progress.wish.side, 0);
  EXPECT_EQ(progress.wish.text, guide.wish());
  EXPECT_EQ(progress.coverage(), guide.coverage());
  ASSERT_EQ(progress.outlines.size(), 1u);
  EXPECT_GE(progress.outlines[0].size(), 4u);
  EXPECT_NEAR(progress.sharp_enough, 0.6 * progress.sharpest, 1e-12);
}

TEST(CaptureGuide, APairNeedsBoth) {
  CaptureGuide guide(kBoard, kSize, true);
  const FoundBoard left = view(320, 240, 0.5), right = view(280, 240, 0.5);
  guide.offer(left, std::nullopt);
  EXPECT_EQ(guide.offer(left, std::nullopt).reason, "no board (right)");
  guide.offer(left, right);
  EXPECT_TRUE(guide.offer(left, right).taken);
}

TEST(CaptureGuide, FollowingItsWishesIsEnough) {
  CaptureGuide guide(kBoard, kSize);
  std::set<std::string> wishes;
  int frames = 0;
  for (; !guide.enough() && frames < 100; ++frames) {
    const std::string wish = guide.wish();
    wishes.insert(wish);
    const auto has = [&](const char* text) { return wish.find(text) != std::string::npos; };
    const double step = 36.0 * (frames % 3);  // nobody shows exactly the same again
    double u = has("left") ? 170 : has("right") ? 470 : 320, v = has("upper") ? 130 : has("lower") ? 350 : 240;
    if (!has("tilt")) {
      show(guide, view(u, v, has("nearer") ? 0.9 : 0.5 + 0.001 * step, 5));
    } else {
      show(guide, view(300 + step, 240, 0.5, 30, has("right") ? 0 : has("lower") ? 90 : has("left") ? 180 : -90));
    }
    if (wish.empty()) show(guide, view(180 + 31 * (frames % 9), 180 + 23 * (frames % 7), 0.6, 20, 20.0 * frames));
  }
  EXPECT_TRUE(guide.enough()) << guide.wish();
  EXPECT_GE(guide.views(), 15);
  EXPECT_EQ(guide.coverage(), 1);
  EXPECT_GE(wishes.size(), 6u);
}

TEST(CaptureGuide, UncertaintyFallsWithViewsAndIsWorstWhereNothingWasSeen) {
  CaptureGuide guide(kBoard, kSize);
  EXPECT_TRUE(guide.uncertainty(8, 6).empty());
  show(guide, view(200, 160, 0.6, 30, 0));
  show(guide, view(240, 160, 0.6, 30, 90));
  show(guide, view(200, 200, 0.6, 30, 180));
  const cv::Mat few = guide.uncertainty(8, 6);
  ASSERT_EQ(few.size(), cv::Size(8, 6));
  EXPECT_GT(few.at<double>(5, 7), 2 * few.at<double>(1, 2));
  show(guide, view(470, 350, 0.5, 30, -90));
  show(guide, view(470, 130, 0.5, 30, 45));
  const cv::Mat more = guide.uncertainty(8, 6);
  EXPECT_LT(cv::mean(more)[0], 0.7 * cv::mean(few)[0]);
}

TEST(CaptureGuide, FlatViewsDoNotTellTheFocalLength) {
  CaptureGuide flat(kBoard, kSize), tilted(kBoard, kSize);
  for (int i = 0; i < 5; ++i) {
    show(flat, view(180 + 60 * i, 240, 0.6));
    show(tilted, view(180 + 60 * i, 240, 0.6, 30, 72 * i));
  }
  EXPECT_GT(cv::mean(flat.uncertainty(8, 6))[0], 3 * cv::mean(tilted.uncertainty(8, 6))[0]);
}

TEST(CaptureSession, TakenImagesAreASetOfPairs) {
  const std::filesystem::path pictures = "/usr/share/doc/opencv-doc/examples/data";
  if (!std::filesystem::exists(pictures / "left01.jpg")) GTEST_SKIP() << "opencv-doc is not installed";
  const TempFolder folder;
  CaptureSession::Options options;
  options.out = folder / "set";
  options.guide.moved_px = 0;
  CaptureSession session(kBoard, options);
  int alike = 0;
  for (int pass = 0; pass < 2; ++pass)
    for (int i = 1; i < 6; ++i) {
      const std::string name = "0" + std::to_string(i) + ".jpg";
      const auto outcome = session.show(cv::imread((pictures / ("left" + name)).string()),
                                        cv::imread((pictures / ("right" + name)).string()));
      alike += outcome.verdict.reason.starts_with("too like view");
      EXPECT_FALSE(pass == 1 && outcome.verdict.taken);
    }
  ASSERT_NE(session.guide(), nullptr);
  EXPECT_GE(session.guide()->views(), 3);
  EXPECT_GE(alike, 5);
  EXPECT_FALSE(session.guide()->enough());
  const auto found = find_pairs_in_folders(folder / "set/left", folder / "set/right", kBoard);
  EXPECT_EQ(static_cast<int>(found.corners.right.views.size()), session.guide()->views());
  EXPECT_EQ(found.corners.left.views[0].name, "001");
  EXPECT_THROW(CaptureSession(kBoard, options), InputError);
}

}  // namespace
}  // namespace foresight::capture_guide_test
