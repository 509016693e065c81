// `foresight calibrate display --images`: from pictures that a simulated eye camera takes of the panel.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/camera/camera_result.hpp"
#include "calibration/formats/camera_formats.hpp"
#include "calibration/result/result_file.hpp"
#include "calibration/robot/rigid_math.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/display_lens/simulated_display.hpp"

namespace foresight::display_images_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kPattern = "1440x1600:9x8:100";

class DisplayImages : public testing::Test {
 protected:
  DisplayImages() {
    display_.pattern = parse_pattern(kPattern);
    // Turned so little that every picture shows the whole pattern.
    for (Pose& T : display_.T_display_camera) T.linear() = rotation_of(0.45 * rotation_vector(T.linear()));
    write_cameras(CameraFormat::camera_info, {{display_.eye}}, folder_ / "eye.yaml", false);
    std::filesystem::create_directories(folder_ / "pictures");
  }
  std::string solve(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"display",
                                 "--pattern",
                                 kPattern,
                                 "--images",
                                 folder_ / "pictures",
                                 "--eye-camera",
                                 folder_ / "eye.yaml",
                                 "--out",
                                 folder_ / "d.yaml",
                                 "--json",
                                 folder_ / "d.json",
                                 "--report",
                                 folder_ / "d.html",
                                 "--force"};
    all.insert(all.end(), more.begin(), more.end());
    return run_calibrate(all);
  }
  void write(const std::string& name, const cv::Mat& picture) const {
    cv::imwrite((folder_ / "pictures" / name).string(), picture);
  }

  const TempFolder folder_;
  SimulatedDisplay display_;
};

TEST_F(DisplayImages, UnseenPointsLieWithinAPixel) {
  ASSERT_EQ(run_calibrate({"display", "--pattern", kPattern, "--pattern-out", folder_ / "panel.png"}), "0");
  const cv::Mat panel = cv::imread((folder_ / "panel.png").string(), cv::IMREAD_GRAYSCALE);
  for (std::size_t i = 0; i < display_.T_display_camera.size(); ++i)
    write("eye" + std::to_string(i) + ".png", picture_of(display_, panel, i));
  write("blank.png", cv::Mat(1024, 1280, CV_8U, cv::Scalar(60)));
  ASSERT_EQ(solve(), "0");
  const auto numbers = json_of(folder_, "d.json");
  EXPECT_EQ(numbers["views"], 3);
  EXPECT_EQ(numbers["points"], 3 * 9 * 8);
  EXPECT_LT(numbers["held_out_px"], 0.3);
  const YamlMap result = read_result(folder_ / "d.yaml", "display").result;
  const CameraModel found = read_camera(result.map("panel"));
  const YAML::Node first_pose = YAML::LoadFile((folder_ / "d.yaml").string())["result"]["T_display_camera"][0];
  const auto q = first_pose["quaternion"].as<std::vector<double>>();
  const Eigen::Matrix3d turn = Eigen::Quaterniond(q.at(3), q.at(0), q.at(1), q.at(2)).toRotationMatrix() *
                               display_.T_display_camera[0].linear().transpose();
  const Eigen::Vector2d first = display_.pattern.corner(0, 0), last = display_.pattern.corner(8, 7);
  const double worst = worst_unseen(display_, found, turn, {first.x(), first.y(), last.x(), last.y()});
  EXPECT_LT(worst, 1);
  RecordProperty("worst_unseen_px", std::to_string(worst));
}

TEST_F(DisplayImages, AFolderWithoutThePatternIsRefused) {
  EXPECT_THAT(solve(), AllOf(HasSubstr("pictures"), HasSubstr("holds no images")));
  write("blank.png", cv::Mat(1024, 1280, CV_8U, cv::Scalar(60)));
  EXPECT_THAT(solve(),
              AllOf(HasSubstr((folder_ / "pictures").string()), HasSubstr("no picture shows the whole pattern")));
  write("small.png", cv::Mat(480, 640, CV_8U, cv::Scalar(60)));
  EXPECT_THAT(solve(), AllOf(HasSubstr("small.png"), HasSubstr("640 x 480"), HasSubstr("1280 x 1024")));
  std::filesystem::remove(folder_ / "pictures/small.png");
  std::ofstream(folder_ / "pictures/broken.png") << "\x89PNG\r\n\x1a\n and no more";
  EXPECT_THAT(solve(), AllOf(HasSubstr("broken.png"), HasSubstr("truncated")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "d.yaml"));
}

}  // namespace
}  // namespace foresight::display_images_test
