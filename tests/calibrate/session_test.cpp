// The commands on recorded data, against figures that others measured on the same images.
#include <gmock/gmock.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/calibrate/run_calibrate.hpp"
#include "tests/support/html_check.hpp"

namespace foresight::session_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kPictures = "/usr/share/doc/opencv-doc/examples/data";

TEST(StereoCommand, OpenCvsPicturesReachTheFrozenFigures) {
  FORESIGHT_NEED_DATA("opencv_stereo_corners");
  if (!std::filesystem::exists(kPictures / "left01.jpg"))
    GTEST_SKIP() << "no pictures at " << kPictures << "; install opencv-doc";
  const TempFolder folder;
  const std::string frozen = (data_folder() / "opencv_stereo_corners/corners_pc25.vnl").string();
  const std::string board = "chessboard:9x6:0.025", result = folder / "stereo.yaml";
  ASSERT_EQ(run_calibrate({"stereo", "--left", kPictures / "left[01]*.jpg", "--right", kPictures / "right[01]*.jpg",
                           "--board", board, "--test-corners", frozen, "--json", folder / "s.json", "--out", result}),
            "0");
  const auto numbers = json_of(folder, "s.json");
  EXPECT_EQ(numbers["views"], 13);
  EXPECT_LE(numbers["in_sample_px"], 0.193);
  EXPECT_LE(numbers["rejected_points"], 2);
  EXPECT_LE(numbers["loo_joint_px"], 0.205);
  EXPECT_LE(numbers["loo_cross_px"], 0.270);
  EXPECT_LE(numbers["loo_epipolar_px"], 0.116);
  const auto verify = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"verify",  "--result", result,   "--corners",      frozen,
                                 "--board", board,      "--json", folder / "v.json"};
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(run_calibrate(all), "1");
    return json_of(folder, "v.json");
  };
  // Another finder's corners of the same pictures, which the result was solved from.
  const auto bent = verify({}), flat = verify({"--flat"});
  EXPECT_EQ(bent["views_of_the_calibration"], 13);
  EXPECT_THAT(bent["failed_because"].dump(), AllOf(HasSubstr("say nothing about others"), HasSubstr("new pictures")));
  EXPECT_LT(bent["joint_px"], flat["joint_px"].get<double>() - 0.001) << "the board is bent, and the result says how";
}

/// Rows of corners in the rectified pictures, left less right, RMS in px.
double row_difference(const cv::FileStorage& file, const std::filesystem::path& left,
                      const std::filesystem::path& right) {
  std::array<std::vector<cv::Point2f>, 2> corners;
  std::array<cv::Mat, 2> P;
  for (const std::size_t side : {0u, 1u}) {
    const std::string n = std::to_string(side + 1);
    cv::Mat M, D, R, map_x, map_y, rectified;
    file["M" + n] >> M, file["D" + n] >> D, file["R" + n] >> R, file["P" + n] >> P[side];
    const cv::Mat picture = cv::imread((side == 0 ? left : right).string(), cv::IMREAD_GRAYSCALE);
    cv::initUndistortRectifyMap(M, D, R, P[side], picture.size(), CV_32F, map_x, map_y);
    cv::remap(picture, rectified, map_x, map_y, cv::INTER_CUBIC);
    if (!cv::findChessboardCornersSB(rectified, {9, 6}, corners[side])) return NAN;
  }
  double squares = 0;
  for (std::size_t i = 0; i < corners[0].size(); ++i) squares += std::pow(corners[0][i].y - corners[1][i].y, 2);
  return std::sqrt(squares / static_cast<double>(corners[0].size()));
}

// Solved from the first nine pairs; the others have not been seen by the solver.
TEST(StereoCommand, TheExportAlignsTheRowsOfPicturesThatNobodySolved) {
  if (!std::filesystem::exists(kPictures / "left01.jpg"))
    GTEST_SKIP() << "no pictures at " << kPictures << "; install opencv-doc";
  const TempFolder folder;
  const std::string board = "chessboard:9x6:0.025", result = folder / "stereo.yaml", report = folder / "s.html";
  ASSERT_EQ(run_calibrate({"stereo", "--left", kPictures / "left0*.jpg", "--right", kPictures / "right0*.jpg",
                           "--board", board, "--model", "radtan4", "--out", result, "--report", report}),
            "0");
  const std::string page = folder.read("s.html");
  EXPECT_EQ(malformed(page), "");
  for (const char* text : {"Coverage", "<b>Usable</b>", "<b>7, left</b>", ">600<"}) EXPECT_THAT(page, HasSubstr(text));
  ASSERT_EQ(run_calibrate({"export", result, "--to", "opencv", "--out", folder / "pair.yml"}), "0");
  const cv::FileStorage file(folder / "pair.yml", cv::FileStorage::READ);
  for (const char* name : {"11", "12", "13", "14"}) {
    const auto left = kPictures / (std::string("left") + name + ".jpg"),
               right = kPictures / (std::string("right") + name + ".jpg");
    const double rows = row_difference(file, left, right);
    RecordProperty(std::string("rows_px_") + name, std::to_string(rows));
    EXPECT_LT(rows, 0.5) << name;
  }
  const auto verify = [&](const std::string& pattern) {
    return run_calibrate({"verify", "--result", result, "--left", kPictures / ("left" + pattern), "--right",
                          kPictures / ("right" + pattern), "--board", board, "--joint", "0.6", "--cross", "0.8",
                          "--epipolar", "0.5", "--json", folder / "v.json"});
  };
  EXPECT_EQ(verify("1*.jpg"), "0");
  EXPECT_EQ(json_of(folder, "v.json")["views_of_the_calibration"], 0);
  EXPECT_EQ(verify("[01]*.jpg"), "0");
  EXPECT_EQ(json_of(folder, "v.json")["views"], 4) << "only those that are new count";
  std::filesystem::create_directories(folder / "copy/l");
  std::filesystem::create_directories(folder / "copy/r");
  for (int i = 1; i <= 5; ++i) {  // other names, another format
    const std::string n = "0" + std::to_string(i) + ".jpg", m = std::to_string(70 + i) + ".png";
    cv::imwrite((folder / "copy/l" / m).string(), cv::imread(kPictures / ("left" + n), cv::IMREAD_GRAYSCALE));
    cv::imwrite((folder / "copy/r" / m).string(), cv::imread(kPictures / ("right" + n), cv::IMREAD_GRAYSCALE));
  }
  EXPECT_EQ(run_calibrate({"verify", "--result", result, "--left", folder / "copy/l", "--right", folder / "copy/r",
                           "--board", board, "--joint", "9", "--cross", "9", "--epipolar", "9"}),
            "1");
}

TEST(StereoCommand, OneCameraTwiceIsNoPair) {
  if (!std::filesystem::exists(kPictures / "left01.jpg"))
    GTEST_SKIP() << "no pictures at " << kPictures << "; install opencv-doc";
  const std::string left = kPictures / "left[01]*.jpg";
  EXPECT_EQ(run_calibrate({"stereo", "--left", left, "--right", left, "--board", "chessboard:9x6:0.025"}), "1");
}

// Its board is hardly tilted: a warp would move the focal length by 1.7 %.
TEST(IntrinsicsCommand, CircleGridGivesThePublishedFocalLength) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  const TempFolder folder;
  const std::string images = (data_folder() / "rct_arm_handeye/test_set_10x10/images").string();
  ASSERT_EQ(
      run_calibrate({"intrinsics", "--images", images, "--board", "circles:10x10:0.0254", "--json", folder / "i.json"}),
      "0");
  const auto numbers = json_of(folder, "i.json");
  EXPECT_NEAR(numbers["fx_px"], 542.3, 0.005 * 542.3);
  EXPECT_NEAR(numbers["fy_px"], 543.5, 0.005 * 543.5);
}

TEST(ArmCommand, CharucoOnAnArmReachesTheMeasuredBar) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  const TempFolder folder;
  const std::filesystem::path set = data_folder() / "rct_arm_handeye/test_set_charuco";
  ASSERT_EQ(run_calibrate({"arm", "--images", set / "images", "--poses", set / "poses", "--board",
                           "charuco:5x7:0.036195", "--json", folder / "a.json", "--out", folder / "a.yaml"}),
            "0");
  EXPECT_LE(json_of(folder, "a.json")["loo_px"], 1.75);
  EXPECT_LE(json_of(folder, "a.json")["loo_mm"], 0.88);
}

TEST(TimeCommand, FindsTheOffsetOfTwoPoseStreams) {
  FORESIGHT_NEED_DATA("handeye_pose_streams");
  const TempFolder folder;
  const std::filesystem::path set = data_folder() / "handeye_pose_streams/robot_arm_w_color_camera_real";
  ASSERT_EQ(run_calibrate({"time", "--poses", set / "robot_arm_complete_bag_color_and_ir_base_link_sr300_hinge.csv",
                           "--camera-poses", set / "robot_arm_complete_bag_color_and_ir_target_ir.csv", "--json",
                           folder / "t.json"}),
            "0");
  const auto numbers = json_of(folder, "t.json");
  EXPECT_NEAR(numbers["offset_s"], -0.020, 0.010);
  EXPECT_GT(numbers["offset_sigma_s"], 0.0002);
  EXPECT_LT(numbers["offset_sigma_s"], 0.010);
}

// Counted as one stretch, all errors would cancel: what is stated must be no smaller then, and outrank nothing.
TEST(TimeCommand, OneStretchNeitherLooksBetterNorReplacesWhatIsHonest) {
  FORESIGHT_NEED_DATA("handeye_pose_streams");
  const TempFolder folder;
  const std::filesystem::path set = data_folder() / "handeye_pose_streams/robot_arm_w_color_camera_real";
  const auto solve = [&](const std::string& segment) {
    return run_calibrate({"time", "--poses", set / "robot_arm_complete_bag_color_and_ir_base_link_sr300_hinge.csv",
                          "--camera-poses", set / "robot_arm_complete_bag_color_and_ir_target_ir.csv", "--segment",
                          segment, "--json", folder / "t.json", "--out", folder / "t.yaml"});
  };
  ASSERT_EQ(solve("2"), "0");
  const double honest = json_of(folder, "t.json")["offset_sigma_s"];
  const std::string kept = folder.read("t.yaml");
  EXPECT_EQ(solve("60"), "1");
  const auto numbers = json_of(folder, "t.json");
  EXPECT_GT(numbers["offset_sigma_s"], 0.5 * honest);
  EXPECT_THAT(numbers["not_usable"].dump(), AllOf(HasSubstr("1 stretch"), HasSubstr("give --segment")));
  EXPECT_EQ(folder.read("t.yaml"), kept);
}

TEST(CalibrateCommands, WrongInputIsNamed) {
  const TempFolder folder;
  EXPECT_THAT(run_calibrate({"stereo", "--corners", "/nowhere.vnl", "--board", "chessboard:9x6:0.025"}),
              HasSubstr("/nowhere.vnl"));
  EXPECT_THAT(run_calibrate({"intrinsics", "--images", folder.path().string(), "--board", "chesboard:9x6:0.025"}),
              HasSubstr("chessboard:9x6"));
  EXPECT_THAT(run_calibrate({"target", "--board", "chessboard:90x60:0.025", "--out", folder / "b.pdf"}),
              HasSubstr("larger --paper"));
  EXPECT_FALSE(std::filesystem::exists(folder / "b.pdf"));
}

}  // namespace
}  // namespace foresight::session_test
