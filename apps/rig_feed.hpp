// The running robot for a rig's window.
#pragma once

#include <functional>
#include <optional>

#include "drivers/robot/robot.hpp"
#include "rig/rig.hpp"
#include "rig_view/rig_window.hpp"

namespace foresight {

/// Hands out the newest of the control loop's cycles that came since it was last called: joints that are homed, and
/// what the robot does or what holds it back, in the words of the status view. `robot` must outlive it; for one thread.
std::function<std::optional<LiveRig>()> rig_feed(const Rig& rig, const Robot& robot);

}  // namespace foresight
