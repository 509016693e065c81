// Where the thing of a task lies by what an operator's side knows: its model, and images that came.
#pragma once

#include "seat/task_watch.hpp"
#include "seat/things_outlook.hpp"

namespace foresight {

/// `thing` and `tray` are nodes of the scene's model, which has the tray where it stands (sim/lab_task.hpp). `time`:
/// the instant that is shown.
ThingLies where_it_lies(const ThingsOutlook& things, const LiveScene& scene, RobotTime time, const std::string& thing,
                        const std::string& tray);

}  // namespace foresight
