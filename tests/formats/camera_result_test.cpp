#include "calibration/camera/camera_result.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "calibration/target/board.hpp"
#include "common/error.hpp"
#include "scene/yaml_fields.hpp"
#include "tests/formats/example_cameras.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::camera_result_test {
namespace {

using testing::HasSubstr;

YamlMap parsed(const YAML::Node& node) {
  return YamlMap::parse("result.yaml", YAML::Dump(node));
}

TEST(CameraResult, ReadsBackEveryModelExactly) {
  for (const Distortion model : {Distortion::radtan4, Distortion::radtan5, Distortion::rational, Distortion::thin_prism,
                                 Distortion::equidistant}) {
    const CameraModel camera = example_camera(model);
    const CameraModel back = read_camera(parsed(to_yaml(camera)));
    EXPECT_EQ(back.distortion, model);
    EXPECT_EQ(back.lens, camera.lens) << to_string(model);
    EXPECT_EQ(back.width, camera.width);
    EXPECT_EQ(back.height, camera.height);
  }
}

TEST(CameraResult, ReadsBackAPair) {
  const CalibratedCameras pair = example_pair(Distortion::radtan4);
  const CalibratedCameras back = read_calibrated_cameras(parsed(to_yaml(pair)));
  EXPECT_EQ(back.right().lens, pair.right().lens);
  EXPECT_LT((back.T_left_right.matrix() - pair.T_left_right.matrix()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(CameraResult, KnowsTheBoardAgain) {
  const auto points = board_points(parse_board("chessboard:9x6:0.025"));
  YAML::Node result = to_yaml(example_camera(Distortion::radtan4));
  EXPECT_FALSE(read_known_board(parsed(result)));
  result["board"] = to_yaml(KnownBoard(points, {0.0004, -0.0001}));
  const auto board = read_known_board(parsed(result));
  ASSERT_TRUE(board);
  EXPECT_EQ(board->warp.x_m, 0.0004);
  EXPECT_EQ(board->warp.y_m, -0.0001);
  EXPECT_TRUE(board->is_laid_out_as(points));
  EXPECT_FALSE(board->is_laid_out_as(board_points(parse_board("chessboard:9x6:0.0251"))));
  EXPECT_FALSE(board->is_laid_out_as(board_points(parse_board("chessboard:6x9:0.025"))));
  EXPECT_FALSE(board->is_laid_out_as(board_points(parse_board("chessboard:17x11:0.0125"))));
  EXPECT_EQ(read_camera(parsed(result)).width, example_camera(Distortion::radtan4).width);
}

TEST(CameraResult, NamesWhatIsWrong) {
  const std::string good = YAML::Dump(to_yaml(example_camera(Distortion::radtan4)));
  const auto message = [&](const std::string& from, const std::string& to) -> std::string {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    try {
      read_camera(YamlMap::parse("r.yaml", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("radtan4", "radtan5"), HasSubstr("distortion"));
  EXPECT_THAT(message("radtan4", "radtan"), HasSubstr("did you mean 'radtan4'"));
  EXPECT_THAT(message("640", "640.5"), HasSubstr("no image size"));
  EXPECT_THAT(message("focal_px: [", "focal_px: [-"), HasSubstr("positive"));
  EXPECT_THAT(message("centre_px", "center_px"), HasSubstr("did you mean 'centre_px'"));
}

}  // namespace
}  // namespace foresight::camera_result_test
