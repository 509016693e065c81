#include "apps/robot/status_view.hpp"

#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "tests/support/folders.hpp"

namespace foresight::status_view_test {
namespace {

TEST(StatusView, ShowsWhatAnOperatorMustKnow) {
  const Rig rig = read_rig(source_folder() / "configs/minerva.yaml");
  RobotStatus status;
  status.phase = RobotPhase::stopped;
  status.gate.state = GateState::stopped;
  status.gate.reason = GateReason::drive_fault;
  status.gate.joint = 5;
  status.gate.detail = "following error";
  const std::string text = status_text(rig, status, {{"can0", CanBusState::bus_off, {}, 0.31}}, 2);
  for (const char* words : {"stopped", "the drive reports a fault (wrist_pitch): following error", ">", "bus-off",
                            "31 %", "overruns", "next: remove the cause that it names, then reset (r)"})
    EXPECT_THAT(text, testing::HasSubstr(words));
}

TEST(StatusView, ShowsWhatHoldsTheRobotBack) {
  const Rig rig = read_rig(source_folder() / "configs/minerva.yaml");
  RobotStatus status;
  status.phase = RobotPhase::ready;
  status.gate.state = GateState::following;
  status.gate.hold = {.joint = 3, .stands = 0.5, .asked = 1, .since = {}, .parts = "link 'arm_5' leaves the workspace"};
  EXPECT_THAT(status_text(rig, status, {}, 2),
              testing::HasSubstr("joint elbow stands at 0.5000 rad and should be at 1.0000 rad: link 'arm_5' leaves"));
}

// Names of own robots may be longer than those of ours.
TEST(StatusView, ColumnsStandBelowEachOtherHoweverLongNamesAre) {
  Rig rig = read_rig(source_folder() / "configs/minerva.yaml");
  rig.joints[2].drive.name = "the_elbow_of_the_upper_left_arm";
  const std::string text = status_text(rig, {}, {}, 1);
  std::set<std::size_t> ends;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (const auto at = line.find("  offline"); at != line.npos) ends.insert(at);
  EXPECT_EQ(ends.size(), 1u) << text;
}

}  // namespace
}  // namespace foresight::status_view_test
