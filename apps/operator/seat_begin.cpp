#include "apps/operator/seat_begin.hpp"

#include "apps/view_measures.hpp"
#include "link/robot_side/rig_identity.hpp"

namespace foresight {

std::shared_ptr<link::PretendedLine> begin_line(const std::optional<LineSpec>& spec, const Clock& clock) {
  if (!spec) return nullptr;
  auto out = std::make_shared<link::PretendedLine>(*spec, link::PretendedLine::Side::operating, clock);
  out->start();
  return out;
}

Identity seat_identity(const Rig& rig, const std::filesystem::path& rig_file, const LiveScene& scene,
                       const std::string& name) {
  Identity out = link::rig_identity(rig, rig_file, FORESIGHT_VERSION);
  out.scene = link::scene_digest(scene);
  out.name = name;
  return out;
}

ScriptedDriver::RobotSays robot_says(const link::OperatorEnd& end) {
  return [&end]() -> std::optional<link::RobotState> {
    auto heard = end.robot_state();
    return heard ? std::optional(std::move(heard->state)) : std::nullopt;
  };
}

RunRecord describe_seat(const Rig& rig, const ViewSession& session, const ViewSetup& setup) {
  RunRecord out = describe(session, setup);
  out.run = rig.name;
  add_texture_options(out, setup.textures);
  return out;
}

}  // namespace foresight
