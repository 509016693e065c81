#include "session/recorder_options.hpp"

#include "common/error.hpp"
#include "sim/run_files.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

/// The encoders' word for head and arm. The ball has no encoder: the model leaves it at rest.
RecordedPoses poses_by_encoders(const sim::LiveLab& world, const sim::ShaftPositions& shafts) {
  RecordedPoses poses{sim::LiveLab::T_world_left_modelled(shafts), {}};
  const sim::LabState state = world.modelled_state(shafts);
  for (std::size_t k = 0; k < state.size(); ++k)
    if (const sim::Part& part = world.lab().parts[k]; part.moves && part.name != sim::kBall)
      poses.T_world_node.emplace_back(part.name, state[k]);
  return poses;
}

}  // namespace

RecorderOptions recorder_options(const StereoConfig& config, const OpenStereo& opened, const sim::ShaftsAt& shafts) {
  RecorderOptions out;
  if (!opened.mock) {
    const auto& [left, right] = config.cameras;
    if (!left.calibration || !right.calibration)
      throw InputError(std::string("the ") + (left.calibration ? "right" : "left") + " camera", "has no calibration",
                       "give it as `lens` in the rig, or with --camera and --camera-right");
    if (!right.calibration->T_left_right)
      throw InputError("the right camera's calibration", "has no T_left_right", "say where the right camera is");
    out.left = left.calibration->lens;
    out.right = right.calibration->lens;
    out.T_left_right = *right.calibration->T_left_right;
    return out;
  }
  out.left = opened.mock->lens(Side::left);
  out.right = opened.mock->lens(Side::right);
  out.T_left_right = opened.mock->T_left_right();
  out.poses = [shafts, world = opened.mock->world()](RobotTime time) {
    return poses_by_encoders(*world, [&](std::string_view joint) { return shafts(joint, time); });
  };
  out.write_scene = [world = opened.mock->world()](const fs::path& folder) {
    sim::ArmPosition arm;
    for (std::size_t j = 0; j < arm.joints.size(); ++j) arm.joints[j] = *sim::shafts_at_rest(sim::arm_joints()[j].name);
    sim::write_scene(folder, world->lab(), arm);
  };
  return out;
}

}  // namespace foresight
