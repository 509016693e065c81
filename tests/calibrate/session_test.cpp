// The commands on recorded data, against figures that others measured on the same images.
#include <gmock/gmock.h>

#include "tests/calibrate/run_calibrate.hpp"

namespace foresight {
namespace {

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
  const std::vector<std::string> verify{"verify", "--result", result, "--corners", frozen, "--board", board};
  const auto joint_of = [&](const std::vector<std::string>& more) {
    auto all = verify;
    all.insert(all.end(), {"--json", folder / "v.json"});
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(run_calibrate(all), "0");
    return json_of(folder, "v.json")["joint_px"].get<double>();
  };
  EXPECT_LT(joint_of({}), joint_of({"--flat"}) - 0.001) << "the board is bent, and the result says how";
  EXPECT_EQ(run_calibrate({"verify", "--result", result, "--corners", frozen, "--board", board, "--cross", "0.1"}),
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
}  // namespace foresight
