#include "apps/robot/status_view.hpp"

#include <gmock/gmock.h>

#include "tests/support/folders.hpp"

namespace foresight {
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
  for (const char* words :
       {"stopped", "the drive reports a fault (wrist_pitch): following error", ">", "bus-off", "31 %", "overruns"})
    EXPECT_THAT(text, testing::HasSubstr(words));
}

}  // namespace
}  // namespace foresight
