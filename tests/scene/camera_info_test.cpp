#include "scene/camera_info.hpp"

#include "test_run.hpp"

namespace foresight::camera_info_test {
namespace {

CameraInfo read(const std::string& text) {
  TempFolder folder;
  return read_camera_info(folder.write("camera.yaml", text));
}

// kCamera with the line that starts with `key` replaced, or `line` added.
std::string with(const std::string& key, const std::string& line) {
  std::string out, current;
  bool found = false;
  for (std::istringstream stream(kCamera); std::getline(stream, current);) {
    const bool hit = current.starts_with(key + ":");
    found = found || hit;
    out += (hit ? line : current) + "\n";
  }
  return found ? out : out + line + "\n";
}

std::string error(const std::string& key, const std::string& line) {
  return input_error([&] { read(with(key, line)); });
}

std::string model(const std::string& name, const std::string& coefficients) {
  std::string text = with("distortion_model", "distortion_model: " + name);
  const auto at = text.find("distortion_coefficients");
  return text.substr(0, at) + "distortion_coefficients: [" + coefficients + "]\n";
}

TEST(CameraInfo, ReadsACalibration) {
  const auto p = read(kCamera).lens.parameters();
  EXPECT_EQ(p.width, 8);
  EXPECT_EQ(p.height, 6);
  EXPECT_EQ(p.fx, 10);
  EXPECT_EQ(p.fy, 11);
  EXPECT_EQ(p.cx, 3.5);
  EXPECT_EQ(p.cy, 2.5);
  EXPECT_EQ(p.model, LensModel::plumb_bob);
  EXPECT_EQ(p.d, (std::array<double, 8>{0.1, -0.02, 0.001, 0.002, 0.003}));
  EXPECT_FALSE(read(kCamera).T_left_right);
}

TEST(CameraInfo, IgnoresTheHarmlessKeys) {
  EXPECT_EQ(input_error([] {
              read(kCamera +
                   "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n"
                   "projection_matrix: {rows: 3, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}\n"
                   "binning_x: 0\nbinning_y: 1\n"
                   "roi: {x_offset: 0, y_offset: 0, width: 8, height: 0, do_rectify: false}\n");
            }),
            "no error");
}

TEST(CameraInfo, TakesTheCoefficientCountsOfEachModel) {
  for (const auto& [name, counts] : std::map<std::string, std::vector<std::string>>{
           {"plumb_bob", {".1, 0, 0, 0", ".1, 0, 0, 0, .1", ".1, 0, 0, 0, .1, 0, 0, 0", "0", "0, 0, 0, 0, 0, 0, 0, 0"}},
           {"rational_polynomial",
            {".1, 0, 0, 0, 0, 0, 0, .2", "0, 0, 0, 0, 0", ".1, 0, 0, 0, 0, 0, 0, .2, 0, 0, 0, 0"}},
           {"equidistant", {".1, 0, 0, .2", "0, 0, 0, 0, 0", ".1, 0, 0, .2, 0"}}})
    for (const std::string& count : counts)
      EXPECT_EQ(input_error([&] { EXPECT_EQ(to_string(read(model(name, count)).lens.model()), name); }), "no error")
          << name << " " << count;
}

TEST(CameraInfo, RefusesOtherCoefficientCounts) {
  const auto refusal = [](const char* name, const char* count) {
    return input_error([&] { read(model(name, count)); });
  };
  EXPECT_THAT(refusal("plumb_bob", ".1, 0, 0"),
              says("distortion_coefficients", "has 3 numbers", "plumb_bob takes 4 or 5"));
  EXPECT_THAT(refusal("plumb_bob", ".1, 0, 0, 0, 0, .1"), says("camera.yaml:6", "has 6 numbers", "takes 4 or 5"));
  EXPECT_THAT(refusal("rational_polynomial", ".1, 0, 0, 0, 0"), says("camera.yaml:6", "has 5", "takes 8"));
  EXPECT_THAT(refusal("equidistant", ".1, 0, 0, 0, .1"), says("camera.yaml:6", "has 5", "equidistant takes 4"));
  EXPECT_THAT(refusal("plumb_bob", ""), says("camera.yaml:6", "has 0", "takes 4 or 5"));
}

TEST(CameraInfo, SuggestsAModel) {
  EXPECT_THAT(error("distortion_model", "distortion_model: plumbob"),
              says("camera.yaml:5: distortion_model", "unknown model 'plumbob'", "did you mean 'plumb_bob'?"));
  EXPECT_THAT(error("distortion_model", "distortion_model: fisheye"),
              testing::HasSubstr("did you mean 'equidistant'?"));
  EXPECT_THAT(error("distortion_model", "distortion_model: rational"), testing::HasSubstr("'rational_polynomial'?"));
}

TEST(CameraInfo, RefusesWhatIsNoCamera) {
  const auto K = [](const char* numbers) {
    return error("camera_matrix", std::string("camera_matrix: [") + numbers + "]");
  };
  EXPECT_THAT(K("0, 0, 3, 0, 9, 2, 0, 0, 1"), says("camera.yaml:4: camera_matrix", "must be positive", "calibrate"));
  EXPECT_THAT(K("9, 0, 3, 0, -9, 2, 0, 0, 1"), says("camera_matrix", "must be positive", "calibrate"));
  EXPECT_THAT(K("9, .1, 3, 0, 9, 2, 0, 0, 1"), says("camera_matrix", "skew", "without skew"));
  EXPECT_THAT(K("9, 0, 3, 0, 9, 2, 0, 0, 2"), says("camera_matrix", "not of the form", "row by row"));
  EXPECT_THAT(K("9, 0, .nan, 0, 9, 2, 0, 0, 1"), says("camera_matrix", "'.nan' is not a finite number", "decimal"));
  EXPECT_THAT(K("9, 0, nan, 0, 9, 2, 0, 0, 1"), says("camera_matrix", "'nan' is not a finite number", "decimal"));
  EXPECT_THAT(K("9, 0, 3, 0, 9, 2, 0, 0"), says("camera_matrix", "has 8 numbers", "write 9"));
  EXPECT_THAT(error("camera_matrix", "camera_matrix: {rows: 3, cols: 2, data: [9, 0, 3, 0, 9, 2, 0, 0, 1]}"),
              says("camera_matrix", "data has 9 numbers", "rows x cols = 6"));
  EXPECT_THAT(error("image_width", "image_width: 0"), says("camera.yaml", "image width", "correct"));
  EXPECT_THAT(error("image_width", "image_width: 8.5"), says("camera.yaml:1", "'8.5' is not an integer", "whole"));
  EXPECT_THAT(error("distortion_coefficients", "distortion_coefficients: [.inf, 0, 0, 0]"),
              says("camera.yaml:6", "'.inf' is not a finite number", "decimal"));
}

// A sign or a decimal point that is lost leaves a picture that sees nothing but its middle.
TEST(CameraInfo, RefusesALensThatFoldsInsideOfThePicture) {
  EXPECT_THAT(error("distortion_coefficients", "distortion_coefficients: [-28, 0.09, 0, 0, 0]"),
              says("camera.yaml:6: distortion_coefficients", "fold the lens back", "camera_matrix"));
}

TEST(CameraInfo, NamesUnknownMissingAndRepeatedKeys) {
  EXPECT_THAT(error("image_widht", "image_widht: 3"),
              says("camera.yaml:7: image_widht", "unknown key", "did you mean 'image_width'?"));
  EXPECT_THAT(error("image_height", ""), says("image_height", "is missing", "add the key 'image_height'"));
  EXPECT_THAT(error("x", "camera_name: twice"), says("camera_name", "appears twice", "remove one"));
}

TEST(CameraInfo, RefusesReducedImages) {
  EXPECT_THAT(error("binning_x", "binning_x: 2"), says("binning_x", "not supported", "binning_x: 1"));
  EXPECT_THAT(error("roi", "roi: {x_offset: 4}"), says("roi", "not supported", "remove roi"));
  EXPECT_THAT(error("roi", "roi: {width: 4, height: 6}"), says("roi", "not supported", "remove roi"));
}

TEST(CameraInfo, RefusesWhatIsNotYaml) {
  const auto refusal = [](const char* text) { return input_error([&] { read(text); }); };
  EXPECT_THAT(refusal("a: 1\nb: [1, 2\n"), says("camera.yaml:", "not valid YAML", "correct the line"));
  EXPECT_THAT(refusal("- a\n"), says("camera.yaml", "not a mapping", "key: value"));
  EXPECT_THAT(refusal(""), says("camera.yaml", "not a mapping", "key: value"));
}

TEST(CameraInfo, ReadsThePlaceOfTheRightCameraInAllForms) {
  const auto place = [](const std::string& text) {
    return *read(kCamera + "T_left_right: " + text + "\n").T_left_right;
  };
  Pose expected = Pose::Identity();
  expected.translation() = Eigen::Vector3d(0.12, 0, 0.01);
  expected.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const std::string numbers = "[0, -1, 0, 0.12, 1, 0, 0, 0, 0, 0, 1, 0.01, 0, 0, 0, 1]";
  for (const std::string& form : {std::string("{xyz: [0.12, 0, 0.01], quaternion: [0, 0, 0.70710678, 0.70710678]}"),
                                  numbers, "{rows: 4, cols: 4, data: " + numbers + "}"})
    EXPECT_TRUE(place(form).isApprox(expected, 1e-7)) << form;
}

TEST(CameraInfo, RefusesAPlaceThatIsNotRigid) {
  const auto refusal = [](const std::string& text) {
    return input_error([&] { read(kCamera + "T_left_right: " + text + "\n"); });
  };
  EXPECT_THAT(refusal("[2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]"),
              says("camera.yaml:7: T_left_right", "no rotation", "orthonormal"));
  EXPECT_THAT(refusal("[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]"),
              says("T_left_right", "no rotation", "orthonormal"));
  EXPECT_THAT(refusal("[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1]"),
              says("T_left_right", "no rotation", "last row 0 0 0 1"));
  EXPECT_THAT(refusal("{xyz: [0, 0, 0], quaternion: [0, 0, 0, 2]}"),
              says("T_left_right", "has length 2", "unit quaternion"));
  EXPECT_THAT(refusal("{xyz: [0, 0]}"), says("T_left_right.xyz", "has 2 numbers", "write 3"));
  EXPECT_THAT(refusal("{xzy: [0, 0, 0]}"), says("T_left_right.xzy", "unknown key", "'xyz'"));
  EXPECT_THAT(refusal("{}"), says("T_left_right", "is empty", "quaternion"));
}

}  // namespace
}  // namespace foresight::camera_info_test
