// A whole session before the mock lab's cameras, whose lenses and places are known.
#include <gmock/gmock.h>

#include <Eigen/SVD>
#include <algorithm>

#include "apps/calibrate/mock_board.hpp"
#include "calibration/camera/camera_result.hpp"
#include "rig/open_stereo.hpp"
#include "scene/yaml_fields.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::mock_session_test {
namespace {

using testing::HasSubstr;

const std::string kBoard = "chessboard:9x6:0.025";

/// Of mock cameras without calibration: the usual lenses.
StereoLenses truth() {
  return mock_options(as_mock({})).lenses;
}

CalibratedCameras model_in(const std::string& result) {
  return read_calibrated_cameras(YamlMap::load(result).map("result"));
}

/// Over the image, how far what the true lens sees at a pixel lies from it through `found`; px, ascending. What a turn
/// of the camera takes up does not count: no picture of a board can tell it from a turned board.
std::vector<double> differences(const Lens& lens, const Lens& found) {
  std::vector<Eigen::Vector3d> rays;
  std::vector<Eigen::Vector2d> pixels;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int v = 0; v < lens.height(); v += 20)
    for (int u = 0; u < lens.width(); u += 20) {
      pixels.emplace_back(u, v);
      rays.push_back(lens.unproject(pixels.back()).value().normalized());
      sum += found.unproject(pixels.back()).value().normalized() * rays.back().transpose();
    }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();  // nearly no turn: never a mirror
  std::vector<double> out;
  for (std::size_t i = 0; i < rays.size(); ++i)
    out.push_back((found.project(turn * rays[i]).value() - pixels[i]).norm());
  std::sort(out.begin(), out.end());
  return out;
}

class MockSession : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (!IsSkipped()) context_.reset();
  }
  std::string capture(const std::string& out, const std::string& seed, const std::string& seconds) const {
    return run_calibrate({"capture", "--mock", "--no-window", "--board", kBoard, "--seed", seed, "--seconds", seconds,
                          "--out", folder_ / out, "--json", folder_ / "c.json"});
  }
  std::string left(const std::string& set) const { return folder_ / (set + "/left"); }
  std::string right(const std::string& set) const { return folder_ / (set + "/right"); }
  const TempFolder folder_;
};

TEST_F(MockSession, FindsLensesAndPlaceFromCaptureToExport) {
  ASSERT_EQ(capture("a", "1", "36"), "0");
  EXPECT_EQ(json_of(folder_, "c.json")["ended"], "enough");
  EXPECT_LE(json_of(folder_, "c.json")["views"], 36);
  const std::string result = folder_ / "stereo.yaml";
  ASSERT_EQ(run_calibrate({"stereo", "--left", left("a"), "--right", right("a"), "--board", kBoard, "--json",
                           folder_ / "s.json", "--out", result}),
            "0");
  const auto numbers = json_of(folder_, "s.json");
  EXPECT_LT(numbers["in_sample_px"], 0.1);
  EXPECT_EQ(numbers["rejected_points"], 0);
  const CalibratedCameras found = model_in(result);
  const StereoLenses true_pair = truth();
  for (const bool second : {false, true}) {
    const std::vector<double> off =
        differences(second ? true_pair.right : true_pair.left, to_lens(second ? found.right() : found.left()));
    const auto said = numbers[second ? "right" : "left"]["uncertainty_at_infinity"];
    std::printf("%s: %.3f px off at the median (%.3f said), %.3f at 90 %% (%.3f), %.3f at worst (%.3f)\n",
                second ? "right" : "left", off[off.size() / 2], said["median_px"].get<double>(),
                off[off.size() * 9 / 10], said["p90_px"].get<double>(), off.back(),
                said["worst_corner_px"].get<double>());
    EXPECT_LT(off[off.size() / 2], 2 * said["median_px"].get<double>());
    EXPECT_LT(off[off.size() / 2], 0.1);
    EXPECT_LT(off[off.size() * 9 / 10], 0.2);
    EXPECT_LT(off.back(), 3 * said["worst_corner_px"].get<double>());
  }
  const Pose error = true_pair.T_left_right.inverse() * found.T_left_right;
  EXPECT_LT(std::abs(found.T_left_right.translation().norm() - sim::kStereoBaseline), 1e-4);
  EXPECT_LT(error.translation().norm(), 2e-4);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.06 * M_PI / 180);

  ASSERT_EQ(capture("b", "2", "6.3"), "1");  // not enough to solve with
  EXPECT_EQ(run_calibrate({"verify", "--result", result, "--left", left("b"), "--right", right("b"), "--board", kBoard,
                           "--joint", "0.1", "--cross", "0.12", "--epipolar", "0.1"}),
            "0");
  for (const std::string form : {"opencv", "kalibr"}) {
    const std::string file = folder_ / (form + ".yaml"), back = folder_ / (form + "_back.yaml");
    ASSERT_EQ(run_calibrate({"export", result, "--to", form, "--out", file}), "0") << form;
    ASSERT_EQ(run_calibrate({"export", file, "--from", form, "--to", "result", "--out", back}), "0") << form;
    EXPECT_LT(differences(to_lens(found.left()), to_lens(model_in(back).left())).back(), 1e-6) << form;
    EXPECT_TRUE(model_in(back).T_left_right.isApprox(found.T_left_right, 1e-9)) << form;
  }
}

TEST_F(MockSession, ABoardOfTheWrongSizeIsRefused) {
  const auto with = [&](const std::string& board) {
    return run_calibrate({"capture", "--mock", "--no-window", "--board", board, "--out", folder_ / "x"});
  };
  EXPECT_THAT(with("chessboard:9x6:0.2"), HasSubstr("the lab has no room for that"));
  EXPECT_THAT(with("charuco:8x6:0.03"), HasSubstr("give charuco:8x6:0.03:0.021:DICT_5X5_1000"));
}

// No pictures: every station of every kind of board is wholly inside of both images, and of any size that the lab
// takes.
TEST(MockBoardPath, ShowsTheWholeBoardToBothCameras) {
  const StereoLenses cameras = truth();
  for (const char* text : {"chessboard:9x6:0.025", "charuco:5x7:0.04:0.03:DICT_5X5_100", "apriltag:6x6:0.055",
                           "circles:10x10:0.02", "chessboard:7x5:0.012"}) {
    SCOPED_TRACE(text);
    const Board board = parse_board(text);
    const MockBoard shown(board, cameras, 3);
    ASSERT_EQ(shown.stations().size(), std::size_t{MockBoard::kStations});
    std::array<bool, 12> seen{};
    double flattest = 90, steepest = 0;
    for (const Pose& T_left_board : shown.stations()) {
      for (const Eigen::Vector3d& p : board_points(board)) {
        const Eigen::Vector2d l = cameras.left.project(T_left_board * p).value(),
                              r = cameras.right.project(cameras.T_left_right.inverse() * T_left_board * p).value();
        for (const Eigen::Vector2d& pixel : {l, r}) {
          ASSERT_GT(pixel.minCoeff(), 5);
          ASSERT_LT(pixel.x(), 634);
          ASSERT_LT(pixel.y(), 474);
        }
        seen[static_cast<std::size_t>(l.y() / 160) * 4 + static_cast<std::size_t>(l.x() / 160)] = true;
      }
      const double tilt = std::acos(T_left_board.linear()(2, 2)) * 180 / M_PI;
      flattest = std::min(flattest, tilt);
      steepest = std::max(steepest, tilt);
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](bool s) { return s; }));
    EXPECT_LT(flattest, 20);
    EXPECT_GT(steepest, 38);
    EXPECT_LT(steepest, 46);
  }
}

}  // namespace
}  // namespace foresight::mock_session_test
