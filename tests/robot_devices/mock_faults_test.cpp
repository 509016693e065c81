// Faults that a user orders for mock drives, and what the gate makes of them.
#include "rig/mock_faults.hpp"

#include <gmock/gmock.h>

#include "common/error.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/support/folders.hpp"

namespace foresight::mock_faults_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class OrderedFaults : public testing::TestWithParam<const char*> {};

TEST_P(OrderedFaults, EachStopsTheRobotAndIsNamed) {
  struct Case {
    const char* kind;
    std::vector<GateReason> reasons;
  };
  using enum GateReason;
  for (const Case& c : {Case{"stuck", {following_error}},
                        {"following_error", {drive_fault}},
                        {"lost_node", {drive_offline, feedback_lost}},
                        {"noisy_encoder", {following_error}},
                        {"lost_power", {drive_offline, feedback_lost}}}) {
    LiveRobot live{GetParam()};
    live.get_moving();
    if (testing::Test::HasFatalFailure()) return;
    MockFaults faults(parse_mock_faults({std::string("elbow:") + c.kind + "@0.5"}, live.rig(), true), live.rig(),
                      live.devices());
    std::vector<std::string> said;
    const RobotTime begin = live.clock().now();
    for (RobotTime now = begin; now < begin + 2500ms; now = live.clock().now()) {
      for (const std::string& line : faults.step(now)) said.push_back(line);
      if (said.empty()) {
        EXPECT_EQ(live.robot().status().gate.state, GateState::following) << c.kind << ": too early";
      }
      live.move(8ms);
    }
    ASSERT_EQ(said.size(), 1u);
    EXPECT_THAT(said[0], testing::AllOf(HasSubstr("0.50 s"), HasSubstr(c.kind), HasSubstr("elbow")));
    const RobotStatus status = live.robot().status();
    EXPECT_EQ(status.phase, RobotPhase::stopped) << c.kind;
    EXPECT_THAT(c.reasons, testing::Contains(status.gate.reason)) << c.kind << ": " << to_string(status.gate.reason);
    EXPECT_EQ(status.gate.joint, static_cast<int>(live.joint("elbow"))) << c.kind;
    live.expect_at_rest(c.kind);
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, OrderedFaults, testing::Values("minerva.yaml", "cia402.yaml"), [](const auto& i) {
  const std::string file = i.param;
  return file.substr(0, file.find('.'));
});

TEST(OrderedFault, SaysWhatIsWrongWithTheOrder) {
  Rig rig = read_rig(source_folder() / "configs/cia402.yaml");
  const auto refusal = [&](const std::string& text, bool all_mock = true) -> std::string {
    try {
      parse_mock_faults({text}, rig, all_mock);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was thrown";
  };
  EXPECT_EQ(refusal("elbow:stuck@0"), "nothing was thrown");
  EXPECT_THAT(refusal("elbow"), testing::AllOf(HasSubstr("JOINT:KIND@TIME"), HasSubstr("shoulder_yaw:stuck@3.5")));
  EXPECT_THAT(refusal("elbo:stuck@1"),
              testing::AllOf(HasSubstr("no joint 'elbo'"), HasSubstr("shoulder_yaw, "), HasSubstr("elbow, ")));
  EXPECT_THAT(refusal("elbow:broken@1"),
              testing::AllOf(HasSubstr("no fault 'broken'"),
                             HasSubstr("stuck, following_error, lost_node, noisy_encoder, lost_power")));
  for (const char* time : {"", "-1", "soon", "nan", "inf"})
    EXPECT_THAT(refusal(std::string("elbow:stuck@") + time), HasSubstr("is no time")) << time;
  rig.buses[0].interface = "can0";
  EXPECT_THAT(refusal("elbow:stuck@1", false), testing::AllOf(HasSubstr("on can0"), HasSubstr("--mock")));
  EXPECT_EQ(refusal("pan:stuck@1", false), "nothing was thrown") << "the other bus is a mock one";
}

}  // namespace
}  // namespace foresight::mock_faults_test
