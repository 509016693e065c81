// What the control loop itself promises, above real networks.
#include <fstream>

#include "tests/robot_devices/live_robot.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/folders.hpp"

namespace foresight::loop_test {
namespace {

using namespace std::chrono_literals;

class Loop : public testing::TestWithParam<const char*> {};

TEST_P(Loop, AllocatesNothingAfterItsStart) {
  LiveRobot live(GetParam());
  live.get_moving();
  std::size_t inside = 0;
  for (int i = 0; i < 2000; ++i) {
    if (i % 2 == 0) live.robot().submit(live.command());
    if (i == 500) live.robot().ask(RobotRequest::emergency_stop);
    if (i == 1000) live.robot().ask(RobotRequest::reset);
    if (i == 1500) live.inject("elbow", sim::DriveFault::overcurrent);
    live.clock().sleep_until(live.clock().now() + 4ms);
    const std::size_t before = allocations();
    live.robot().cycle(live.clock().now());
    inside += allocations() - before;
  }
  EXPECT_EQ(inside, 0u);
  EXPECT_EQ(live.robot().status().phase, RobotPhase::stopped);
}

TEST_P(Loop, ADriveThatIsAnotherThanTheRigSaysIsNeverEnabled) {
  SteppedClock clock;
  Rig rig = read_rig(source_folder() / "configs" / GetParam());
  rig.joints[3].drive.serial = 4711;
  RobotDeviceOptions options;
  options.mock = true;
  RobotDevices devices(rig, clock, options);
  devices.rack(0)->inject(3, sim::DriveFault::wrong_identity);
  const std::string error = input_error([&] { devices.bring_up([](const std::string&) {}); });
  EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("elbow"), testing::HasSubstr("serial")));
  Robot robot(rig.gate_options(), nullptr, devices.networks(), devices.drives());
  robot.ask(RobotRequest::enable);
  for (int i = 0; i < 2000; ++i) {
    clock.sleep_until(clock.now() + 4ms);
    robot.cycle(clock.now());
  }
  EXPECT_STRNE(to_string(robot.status().phase), "ready");
  for (std::size_t i = 0; i < devices.rack(0)->size(); ++i) EXPECT_FALSE(devices.rack(0)->shaft(i).powered) << i;
}

/// A session, its log of both buses as one text.
std::string session(const char* rig_file, const std::filesystem::path& folder) {
  SteppedClock clock;
  const Rig rig = read_rig(source_folder() / "configs" / rig_file);
  RobotDeviceOptions options;
  options.mock = true;
  options.log = folder / "session.log";
  {
    RobotDevices devices(rig, clock, options);
    Robot robot(rig.gate_options(), nullptr, devices.networks(), devices.drives());
    devices.bring_up([](const std::string&) {});
    std::stop_source stop;
    std::uint64_t sequence = 0;
    const RobotTime start = clock.now();
    clock.every(8ms, [&](RobotTime now) {
      if (now - start < 16ms) robot.ask(RobotRequest::enable);
      if (now - start > 500ms && now - start < 516ms) robot.ask(RobotRequest::home);
      MotionCommand command{1, ++sequence, now, robot.status().all_homed && now - start > 1s, rig.joints.size(), {}};
      command.position[3] = 0.5;
      robot.submit(command);
      if (now - start > 15s) stop.request_stop();
    });
    robot.run(clock, stop.get_token());
  }
  std::string out;
  for (const char* name : {"session-arm.log", "session-head.log"}) {
    std::ifstream stream(folder / name, std::ios::binary);
    out.append(std::istreambuf_iterator<char>(stream), {});
  }
  return out;
}

TEST_P(Loop, ASteppedSessionHasTheSameFramesOnEveryRun) {
  TempFolder one, other;
  const std::string first = session(GetParam(), one.path()), second = session(GetParam(), other.path());
  EXPECT_GT(first.size(), 100'000u);
  EXPECT_TRUE(first == second);
}

INSTANTIATE_TEST_SUITE_P(Rigs, Loop, testing::Values("minerva.yaml", "cia402.yaml"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find('.')); });

}  // namespace
}  // namespace foresight::loop_test
