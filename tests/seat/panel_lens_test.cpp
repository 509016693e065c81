// The lens that `calibrate display` writes is the one that a seat draws through.
#include "seat/panel_lens.hpp"

#include <gtest/gtest.h>

#include "calibration/camera/camera_result.hpp"
#include "calibration/result/result_file.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::panel_lens_test {
namespace {

ResultHeader header(const char* kind) {
  return {kind, "2026-03-01T14:05:09Z", {}, "held_out_px", 0.1, {{"focal_px", 1}}};
}

TEST(PanelLens, IsReadAsItWasFound) {
  const TempFolder folder;
  const Lens lens = small_lens("rational");
  YAML::Node result;
  result["panel"] = to_yaml(to_camera_model(lens));
  write_result(folder / "display.yaml", header("display"), result, false);
  const Lens read = read_panel_lens(folder / "display.yaml");
  const Eigen::Vector3d p(0.2, -0.1, 1);
  EXPECT_LT((read.project(p).value() - lens.project(p).value()).norm(), 1e-6);
  EXPECT_EQ(read.width(), lens.width());
}

TEST(PanelLens, AnotherResultIsRefused) {
  const TempFolder folder;
  write_result(folder / "arm.yaml", header("arm"), YAML::Node(YAML::NodeType::Map), false);
  EXPECT_THROW(read_panel_lens(folder / "arm.yaml"), InputError);
}

}  // namespace
}  // namespace foresight::panel_lens_test
