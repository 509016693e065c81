#include "apps/operator/thing_lies.hpp"

#include "seat/tool_script.hpp"
#include "sim/lab_task.hpp"

namespace foresight {

ThingLies where_it_lies(const ThingsOutlook& things, const LiveScene& scene, RobotTime time, const std::string& thing,
                        const std::string& tray) {
  const JointPositions rest = [](std::string_view) { return std::nullopt; };
  SceneState state = scene.state_at(time, rest, StateStatus::predicted);
  things.place(state);
  const auto node = static_cast<std::size_t>(scene.model()->find(thing).value());
  if (!sim::lies_in_tray(state.T_world_node[node], place_at_rest(scene, tray))) return ThingLies::elsewhere;
  return things.seen_at_rest(thing) ? ThingLies::in_place : ThingLies::unseen;
}

}  // namespace foresight
