#include "session/robot_loop.hpp"

#include <future>

#include "common/error.hpp"
#include "common/real_time.hpp"

namespace foresight {
namespace {

constexpr const char* kReal = "add --mock, or leave --stepped out";

}  // namespace

RobotLoop::RobotLoop(MonotonicClock& clock, Robot& robot, RobotDevices& devices, Say say) {
  std::promise<void> up;
  std::future<void> is_up = up.get_future();
  thread_ = std::jthread([&clock, &robot, &devices, say, up = std::move(up)](const std::stop_token& stop) mutable {
    if (const std::string refused = make_real_time(priority::kControlLoop); !refused.empty()) say(refused);
    // In this thread: the drives' watchdogs would find the bus silent while a new one gets its stack, every page of
    // which is locked in memory.
    try {
      devices.bring_up(say);
    } catch (...) {
      return up.set_exception(std::current_exception());
    }
    up.set_value();
    robot.run(clock, stop, [&devices, &say] {
      try {
        devices.bring_up(say);
      } catch (const std::exception& error) {
        say(error.what());
      }
    });
  });
  is_up.get();
}

void require_mock(const Rig& rig, bool mock, bool cameras) {
  if (mock) return;
  for (const RigBus& bus : rig.buses)
    if (bus.interface != "mock")
      throw InputError("--stepped", "bus '" + bus.name + "' is a real one, whose time cannot be stepped", kReal);
  if (cameras && rig.cameras && !rig.cameras->mock())
    throw InputError("--stepped", "the cameras are real ones, whose time cannot be stepped", kReal);
}

}  // namespace foresight
