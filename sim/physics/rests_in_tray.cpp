#include "sim/physics/rests_in_tray.hpp"

#include "sim/lab_task.hpp"

namespace foresight::sim {

bool rests_in_tray(PhysicalLab& physics, const std::string& thing, const Pose& T_world_tray, RobotTime time) {
  constexpr Duration kStill = std::chrono::milliseconds(100);
  constexpr double kHardly = 1e-3;  // m
  const Pose before = physics.thing_at(thing, time - kStill), now = physics.thing_at(thing, time);
  return lies_in_tray(now, T_world_tray) && (now.translation() - before.translation()).norm() < kHardly;
}

}  // namespace foresight::sim
