#include "rig/home_check.hpp"

#include <gmock/gmock.h>

#include "tests/support/folders.hpp"

namespace foresight::home_check_test {
namespace {

using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

Rig minerva() {
  return read_rig(source_folder() / "configs/minerva.yaml");
}

TEST(HomeCheck, MinervaStandsClear) {
  EXPECT_THAT(parts_too_close_at_home(minerva()), IsEmpty());
}

TEST(HomeCheck, NamesLinksInAnObstacleAndOutsideOfTheWorkspace) {
  Rig rig = minerva();
  rig.surroundings.obstacles = {{"crate", {Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1.2)}}};
  EXPECT_THAT(parts_too_close_at_home(rig), Contains(Field(&TooClose::what, HasSubstr("'crate'"))));
  rig = minerva();
  rig.surroundings.workspace = {Eigen::Vector3d(-0.1, -0.1, 0), Eigen::Vector3d(0.1, 0.1, 0.1)};
  for (const TooClose& parts : parts_too_close_at_home(rig)) EXPECT_TRUE(parts.touch) << parts.what;
  EXPECT_THAT(parts_too_close_at_home(rig), Contains(Field(&TooClose::what, HasSubstr("leaves the workspace"))));
}

TEST(HomeCheck, SaysInALineWhatTheGateWouldDo) {
  Rig rig = minerva();
  EXPECT_THAT(words_on_home(parts_too_close_at_home(rig)), IsEmpty());
  rig.surroundings.workspace = {Eigen::Vector3d(-0.1, -0.1, 0), Eigen::Vector3d(0.1, 0.1, 0.1)};
  EXPECT_THAT(
      words_on_home(parts_too_close_at_home(rig)),
      Contains(testing::AllOf(testing::StartsWith("at home link '"), HasSubstr("leaves the workspace"),
                              HasSubstr("; correct surroundings, robot.pose or the joint's offset: the gate"))));
}

TEST(HomeCheck, ARigWithoutABodyHasNothingToCheck) {
  Rig rig = minerva();
  rig.robot.reset();
  EXPECT_THAT(parts_too_close_at_home(rig), IsEmpty());
}

}  // namespace
}  // namespace foresight::home_check_test
