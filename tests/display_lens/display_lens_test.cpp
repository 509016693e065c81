#include "calibration/display_lens/display_lens.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/display_lens/simulated_display.hpp"

namespace foresight::display_lens_test {
namespace {

using testing::HasSubstr;

DisplayLensOptions options_for(const SimulatedDisplay& display) {
  DisplayLensOptions options;
  options.panel_width = display.panel.width;
  options.panel_height = display.panel.height;
  return options;
}

TEST(DisplayLens, UnseenPointsLieWithinAPixel) {
  const SimulatedDisplay display;
  const DisplayLensSummary summary = solve_display_lens(display.points(0.15, 1), display.eye, options_for(display));
  EXPECT_LT(summary.held_out_px, 0.5);
  EXPECT_LT(summary.held_out_worst_px, 1.2) << "with the noise of the points themselves";
  const Eigen::Matrix3d turn = summary.T_display_camera[0].linear() * display.T_display_camera[0].linear().transpose();
  EXPECT_LT(worst_unseen(display, summary.panel, turn), 1);
  EXPECT_EQ(summary.rejected, 0) << summary.points;
  EXPECT_NEAR(summary.panel.lens[0], display.panel.lens[0], 4 * summary.sigma_focal_px + 0.5);
  EXPECT_NEAR(summary.panel.lens[2], display.panel.lens[2], 4 * summary.sigma_centre_px + 0.5);
  EXPECT_GT(summary.sigma_focal_px, 0);
  RecordProperty("worst_unseen_px", std::to_string(worst_unseen(display, summary.panel, turn)));
}

TEST(DisplayLens, AFishEyeDisplayIsRecognised) {
  SimulatedDisplay display;
  display.panel = {1440, 1600, Distortion::equidistant, {800, 800, 715, 805, 0.02, -0.01, 0.002, 0}};
  const DisplayLensSummary summary = solve_display_lens(display.points(0.1, 2), display.eye, options_for(display));
  EXPECT_LT(summary.held_out_px, 0.4);
  const Eigen::Matrix3d turn = summary.T_display_camera[0].linear() * display.T_display_camera[0].linear().transpose();
  EXPECT_LT(worst_unseen(display, summary.panel, turn), 1);
}

TEST(DisplayLens, OutliersAreRejectedAndCounted) {
  const SimulatedDisplay display;
  auto points = display.points(0.1, 3);
  for (std::size_t i = 0; i < points.size(); i += 97) points[i].panel_pixel.x() += 30;
  const auto bad = static_cast<int>((points.size() + 96) / 97);
  const DisplayLensSummary summary = solve_display_lens(points, display.eye, options_for(display));
  EXPECT_GE(summary.rejected, bad);
  EXPECT_LE(summary.rejected, bad + 3);
  EXPECT_LT(summary.held_out_px, 0.4);
}

// Pictures from places 12 mm apart, the virtual image 1.3 m away.
TEST(DisplayLens, FindsTheEyesPosition) {
  SimulatedDisplay display;
  display.T_display_camera[1].translation() = Eigen::Vector3d(0.012, 0.001, -0.002);
  display.T_display_camera[2].translation() = Eigen::Vector3d(-0.004, 0.012, 0.003);
  DisplayLensOptions options = options_for(display);
  options.models = {Distortion::radtan5};
  options.virtual_distance_m = 1.3;
  const DisplayLensSummary summary = solve_display_lens(display.points(0.1, 4, 1.3), display.eye, options);
  EXPECT_EQ(summary.T_display_camera[0].translation().norm(), 0);
  for (std::size_t i = 1; i < 3; ++i)
    EXPECT_LT((summary.T_display_camera[i].translation() - display.T_display_camera[i].translation()).norm(), 0.002);
}

TEST(DisplayLens, ColoursDifferInScale) {
  const SimulatedDisplay display;
  SimulatedDisplay red = display;
  red.panel.lens[0] *= 1.004;
  red.panel.lens[1] *= 1.004;
  const DisplayLensOptions options = options_for(display);
  const DisplayLensSummary base = solve_display_lens(display.points(0.05, 5), display.eye, options);
  const CameraModel found = solve_colour(red.points(0.05, 6), display.eye, base, options);
  EXPECT_NEAR(found.lens[0] / base.panel.lens[0], 1.004, 5e-4);
  EXPECT_EQ(found.lens[2], base.panel.lens[2]);
}

TEST(DisplayLens, NamesWhatIsWrong) {
  const SimulatedDisplay display;
  const auto refusal = [&](const std::vector<PanelPoint>& points) -> std::string {
    try {
      solve_display_lens(points, display.eye, options_for(display));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  auto points = display.points(0.1, 7);
  EXPECT_THAT(refusal({}), HasSubstr("no point"));
  EXPECT_THAT(refusal({points.begin(), points.begin() + 8}), HasSubstr("picture 1: shows 8 points"));
  std::vector<PanelPoint> row = points;
  std::erase_if(
      row, [&](const PanelPoint& p) { return p.picture || p.panel_pixel.y() != display.pattern.corner(0, 8).y(); });
  ASSERT_GE(row.size(), 12u);
  EXPECT_THAT(refusal(row), HasSubstr("line"));
  for (PanelPoint& p : points) p.panel_pixel.x() = 1439 - p.panel_pixel.x();
  EXPECT_THAT(refusal(points), HasSubstr("mirrored"));
}

}  // namespace
}  // namespace foresight::display_lens_test
