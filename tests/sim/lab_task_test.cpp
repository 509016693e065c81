// Arrangements of things for a hand.
#include "sim/lab_task.hpp"

namespace foresight::lab_task_test {
namespace {

using sim::TaskLayout;

TEST(LabTask, EveryLayoutLeavesRoomForAHand) {
  for (unsigned number = 0; number < 200; ++number) {
    const TaskLayout layout = sim::task_layout(number);
    const Eigen::Vector3d red = layout.brick_red.translation(), blue = layout.brick_blue.translation();
    EXPECT_GT((red - blue).norm(), sim::kBrickSide + 0.06) << number;
    for (const Eigen::Vector3d& brick : {red, blue}) {
      EXPECT_GT((brick - layout.tray.translation()).head<2>().norm(), sim::kTraySide / 2 + 0.04) << number;
      EXPECT_NEAR(brick.z(), red.z(), 1e-12);
    }
    EXPECT_FALSE(sim::lies_in_tray(layout.brick_red, layout.tray));
  }
}

TEST(LabTask, ANumberIsALayout) {
  const TaskLayout one = sim::task_layout(7), same = sim::task_layout(7), other = sim::task_layout(8);
  EXPECT_TRUE(one.brick_red.isApprox(same.brick_red));
  EXPECT_FALSE(one.brick_red.isApprox(other.brick_red));
}

TEST(LabTask, AThingLiesInATurnedTray) {
  const Pose tray = sim::task_layout(3).tray;
  Pose corner = tray * Eigen::Translation3d(0.07, 0.07, sim::kTrayBoard);
  EXPECT_TRUE(sim::lies_in_tray(corner, tray));
  corner = tray * Eigen::Translation3d(0.08, 0, sim::kTrayBoard);
  EXPECT_FALSE(sim::lies_in_tray(corner, tray));
  EXPECT_FALSE(sim::lies_in_tray(tray * Eigen::Translation3d(0, 0, 0.1), tray)) << "held above it";
  EXPECT_FALSE(sim::lies_in_tray(tray, tray)) << "fallen through it, onto the table";
}

}  // namespace
}  // namespace foresight::lab_task_test
