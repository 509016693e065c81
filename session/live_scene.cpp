#include "session/live_scene.hpp"

#include "common/error.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

StereoLenses lenses_of(const sim::MockStereo& mock) {
  return {mock.lens(Side::left), mock.lens(Side::right), mock.T_left_right()};
}

std::optional<StereoLenses> lenses_of(const StereoConfig& config) {
  const auto& left = config.camera(Side::left).calibration;
  const auto& right = config.camera(Side::right).calibration;
  if (!left || !right) return std::nullopt;
  if (!right->T_left_right)
    throw InputError("the right camera's calibration", "has no T_left_right", "say where the right camera is");
  return StereoLenses{left->lens, right->lens, *right->T_left_right};
}

}  // namespace

LiveScene::LiveScene(const sim::MockStereo& mock) : LiveScene(mock.world(), lenses_of(mock)) {}

LiveScene::LiveScene(std::shared_ptr<const sim::LiveLab> world, const StereoLenses& lenses)
    : lenses_(lenses), lab_(std::move(world)) {
  model_ = std::make_shared<const SceneModel>(lab_->modelled_scene());
}

LiveScene::LiveScene(const StereoConfig& cameras, const Rig* rig, const std::optional<fs::path>& scene_file)
    : lenses_(lenses_of(cameras)), real_(rig_scene(rig, scene_file)) {
  model_ = real_->model();
}

SceneState LiveScene::state_at(RobotTime time, const JointPositions& joints, StateStatus status) const {
  if (!model_) return {time, status, {}};
  return {time, status, lab_ ? lab_->modelled_state(joints) : real_->poses(joints)};
}

Pose LiveScene::T_world_left(const JointPositions& joints) const {
  return sim::LiveLab::T_world_left_modelled(joints);
}

LiveScene live_scene_of(const Rig& rig, bool mock, const std::optional<fs::path>& scene_file, bool physics,
                        unsigned layout) {
  const StereoConfig config = mock ? as_mock(*rig.cameras) : *rig.cameras;
  if (!config.mock()) return {config, &rig, scene_file};
  MockWorld world = mock_world(rig, scene_file);
  if (physics) world.physics.emplace();
  world.layout = layout;
  return {mock_lab(world), mock_options(config).lenses};
}

}  // namespace foresight
