#include "rig_view/panel.hpp"

#include <gtest/gtest.h>

namespace foresight::panel_test {
namespace {

TEST(Panel, SlidersReachBothLimitsAndRowsDoNotOverlap) {
  DriveConfig drive;
  drive.min_position = -1.5;
  drive.max_position = 2.5;
  for (const std::size_t joints : {1u, 7u, 16u}) {
    const PanelLayout layout(joints, 860);
    for (std::size_t i = 0; i < joints; ++i) {
      const cv::Rect slider = layout.slider(i);
      EXPECT_EQ((slider & layout.row(i)), slider);
      if (i > 0) {
        EXPECT_EQ((layout.row(i) & layout.row(i - 1)).area(), 0);
      }
      EXPECT_DOUBLE_EQ(layout.position_at(drive, i, slider.x - 50), -1.5);
      EXPECT_DOUBLE_EQ(layout.position_at(drive, i, slider.x + slider.width + 50), 2.5);
      EXPECT_NEAR(layout.position_at(drive, i, slider.x + slider.width / 2), 0.5, 0.05);
      EXPECT_EQ(layout.joint_at({slider.x + 3, slider.y + 1}), i);
    }
    const cv::Rect names = layout.legend(7);
    EXPECT_EQ(layout.layer_at({names.x + 4, names.y + 4}), 7u);
    EXPECT_FALSE(layout.joint_at({names.x + 4, names.y + 4}));
    EXPECT_LT(layout.rest().y, 860) << "no room for what is nearest";
  }
}

}  // namespace
}  // namespace foresight::panel_test
