#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "calibration/camera/camera_result.hpp"
#include "calibration/formats/urdf_offsets.hpp"
#include "calibration/result/result_file.hpp"
#include "scene/camera_info.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/display_lens/simulated_display.hpp"
#include "tests/formats/example_cameras.hpp"
#include "tests/photometric/synthetic_camera.hpp"
#include "tests/support/html_check.hpp"

namespace foresight::export_scene_display_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string stereo_result(const TempFolder& folder, Distortion model) {
  const CalibratedCameras pair = example_pair(model);
  ResultHeader header{"stereo", utc_now(), {{"left", "1"}}, "loo_joint_px", 0.2, {}};
  const auto file = folder / "stereo.yaml";
  write_result(file, header, to_yaml(pair), true);
  return file.string();
}

TEST(ExportCommand, GoesThroughAllFormatsAndBack) {
  const TempFolder folder;
  std::string from = "result", file = stereo_result(folder, Distortion::radtan4);
  for (const std::string to : {"camera-info", "kalibr", "opencv", "mrcal", "result"}) {
    const std::string out = (folder / to).string();
    ASSERT_EQ(run_calibrate({"export", file, "--from", from, "--to", to, "--out", out, "--json", folder / "n.json",
                             "--report", folder / "r.html"}),
              "0");
    EXPECT_EQ(json_of(folder, "n.json")["rays"], 1000);
    EXPECT_LT(json_of(folder, "n.json")["worst_px"], 1e-9);
    EXPECT_EQ(malformed(folder.read("r.html")), "");
    from = to, file = out;
  }
  const CalibratedCameras back = read_calibrated_cameras(read_result(file, "stereo").result);
  const CalibratedCameras pair = example_pair(Distortion::radtan4);
  EXPECT_LT(worst_ray(pair, back, 1000), 1e-9);
}

TEST(ExportCommand, WritesUrdf) {
  const TempFolder folder;
  const std::string result = stereo_result(folder, Distortion::radtan4), out = folder / "rig.urdf";
  ASSERT_EQ(run_calibrate({"export", result, "--to", "urdf", "--out", out}), "0");
  const Pose T = read_mount(folder.read("rig.urdf"), "right_camera", out).T_parent_child;
  EXPECT_LT((T.matrix() - example_pair(Distortion::radtan4).T_left_right.matrix()).norm(), 1e-12);
  EXPECT_THAT(run_calibrate({"export", result, "--to", "urdf", "--out", out}), HasSubstr("--force"));
  const auto arm = folder.write("arm.yaml",
                                "kind: arm\ndate: 2026-01-01T00:00:00Z\nscore: {name: loo_px, value: 1}\n"
                                "result: {joint_offsets: {shoulder: 0.01}}\n");
  EXPECT_THAT(run_calibrate({"export", arm, "--to", "urdf", "--out", folder / "a.urdf"}), HasSubstr("--urdf"));
}

TEST(ExportCommand, SaysWhatIsWrong) {
  const TempFolder folder;
  const std::string result = stereo_result(folder, Distortion::equidistant);
  EXPECT_THAT(run_calibrate({"export", result, "--to", "mrcal", "--out", folder / "m"}),
              AllOf(HasSubstr("equidistant"), HasSubstr("kalibr")));
  EXPECT_FALSE(std::filesystem::exists(folder / "m"));
  EXPECT_THAT(run_calibrate({"export", result, "--to", "kalibr"}), HasSubstr("--out"));
  EXPECT_THAT(run_calibrate({"export", result, "--to", "calibr", "--out", "x"}), HasSubstr("calibr"));
  EXPECT_THAT(run_calibrate({"export", "absent.yaml", "--to", "kalibr", "--out", "x"}), HasSubstr("absent.yaml"));
  EXPECT_THAT(run_calibrate({"export", result, "--to", "kalibr", "--out", "/proc/x.yaml"}), HasSubstr("/proc"));
}

TEST(SceneCommand, PlacesAModelAndRefusesAnother) {
  const TempFolder folder;
  const auto points = folder.write("p.txt", "0 0 0 1 2 3\n1 0 0 1 3 3\n0 1 0 0 2 3\n0 0 1 1 2 4\n");
  const std::string out = folder / "scene.yaml";
  ASSERT_EQ(run_calibrate({"scene", "--points", points, "--out", out, "--json", folder / "n.json", "--report",
                           folder / "r.html"}),
            "0");
  const Pose T = read_result(out, "scene").result.pose("T_world_model");
  EXPECT_LT((T * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-9);
  EXPECT_LT(json_of(folder, "n.json")["loo_mm"], 1e-6);
  EXPECT_EQ(malformed(folder.read("r.html")), "");
  const auto mesh = folder.write("m.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  EXPECT_THAT(run_calibrate({"scene", "--points", points, "--model", mesh}), HasSubstr("outside of the model"));
  EXPECT_THAT(run_calibrate({"scene"}), HasSubstr("--points"));
  const auto wrong = folder.write("w.txt", "0 0 0 1 2 3\n1000 0 0 1 3 3\n0 1000 0 0 2 3\n0 0 1000 1 2 4\n");
  EXPECT_THAT(run_calibrate({"scene", "--points", wrong}), HasSubstr("millimetres"));
}

TEST(DisplayCommand, WritesThePatternAndSolvesFromPoints) {
  const TempFolder folder;
  const SimulatedDisplay display;
  write_cameras(CameraFormat::camera_info, {{display.eye}}, folder / "eye.yaml", false);
  std::string rows;
  for (const PanelPoint& p : display.points(0.1, 3))
    rows += std::to_string(p.picture) + " " + std::to_string(p.camera_pixel.x()) + " " +
            std::to_string(p.camera_pixel.y()) + " " + std::to_string(p.panel_pixel.x()) + " " +
            std::to_string(p.panel_pixel.y()) + "\n";
  const auto points = folder.write("points.txt", rows);
  const std::string pattern = "1440x1600:15x16:88";
  ASSERT_EQ(run_calibrate({"display", "--pattern", pattern, "--pattern-out", folder / "p.png"}), "0");
  EXPECT_EQ(cv::imread((folder / "p.png").string()).size(), cv::Size(1440, 1600));
  ASSERT_EQ(run_calibrate({"display", "--pattern", pattern, "--corners", points, "--eye-camera", folder / "eye.yaml",
                           "--out", folder / "d.yaml", "--json", folder / "n.json", "--report", folder / "r.html"}),
            "0");
  EXPECT_LT(json_of(folder, "n.json")["held_out_px"], 0.4);
  EXPECT_EQ(read_camera(read_result(folder / "d.yaml", "display").result.map("panel")).width, 1440);
  EXPECT_EQ(malformed(folder.read("r.html")), "");
  ASSERT_EQ(run_calibrate({"export", folder / "d.yaml", "--to", "camera-info", "--out", folder / "panel.yaml"}), "0");
  EXPECT_EQ(read_camera_info(folder / "panel.yaml").lens.height(), 1600);
  EXPECT_THAT(run_calibrate({"display", "--pattern", pattern}), HasSubstr("--images"));
  EXPECT_THAT(run_calibrate({"display", "--pattern", pattern, "--corners", points}), HasSubstr("--eye-camera"));
  EXPECT_THAT(
      run_calibrate({"display", "--pattern", pattern, "--images", folder.path(), "--eye-camera", folder / "eye.yaml"}),
      HasSubstr("p.png"));
}

TEST(PhotometricCommand, FindsTheGainOfAPair) {
  const TempFolder folder;
  const std::vector<double> exposures{0.1, 0.2, 0.4, 0.8, 1.6};
  std::string rows;
  for (const char* side : {"left", "right"}) {
    SyntheticCamera camera;
    camera.gain = side == std::string("left") ? 1 : 0.9;
    std::filesystem::create_directories(folder / side);
    for (const ExposedImage& image : series_of(camera, cv::Mat(240, 320, CV_64F, cv::Scalar(0.5)), exposures, 11)) {
      cv::imwrite((folder / side / image.name).string(), image.pixels);
      if (camera.gain == 1) rows += image.name + " " + std::to_string(image.exposure_s) + "\n";
    }
  }
  const auto times = folder.write("exposures.txt", rows);
  ASSERT_EQ(
      run_calibrate({"photometric", "--left-flat", folder / "left", "--right-flat", folder / "right", "--exposures",
                     times, "--out", folder / "p.yaml", "--json", folder / "n.json", "--report", folder / "r.html"}),
      "0");
  const auto numbers = json_of(folder, "n.json");
  EXPECT_NEAR(numbers["gain_right_over_left"], 0.9, 0.01);
  EXPECT_EQ(numbers["left"]["inverse_response"].size(), 256u);
  EXPECT_EQ(read_result(folder / "p.yaml", "photometric").result.map("left").numbers("inverse_response").size(), 256u);
  EXPECT_EQ(malformed(folder.read("r.html")), "");
  const auto identical = folder / "identical";
  std::filesystem::create_directories(identical);
  for (const ExposedImage& image : series_of({}, cv::Mat(240, 320, CV_64F, cv::Scalar(0.5)), exposures, 11))
    std::filesystem::copy(folder / "left/image2.png", identical / image.name);
  EXPECT_EQ(run_calibrate({"photometric", "--flat", identical, "--exposures", times, "--force", "--out",
                           folder / "p.yaml", "--json", folder / "i.json"}),
            "1");
  EXPECT_THAT(json_of(folder, "i.json")["not_usable"].dump(),
              AllOf(HasSubstr("image0.png and image1.png"), HasSubstr("automatic exposure")));
  EXPECT_TRUE(read_result(folder / "p.yaml", "photometric").result.has("left")) << "kept as it was";
  EXPECT_THAT(run_calibrate({"photometric"}), HasSubstr("--images"));
  EXPECT_THAT(run_calibrate({"photometric", "--images", folder / "left"}), HasSubstr("--exposures"));
}

}  // namespace
}  // namespace foresight::export_scene_display_test
