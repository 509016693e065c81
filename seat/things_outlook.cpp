#include "seat/things_outlook.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/real_time.hpp"
#include "rig/rig_scene.hpp"
#include "seat/predicted_place.hpp"
#include "seat/robot_outlook.hpp"
#include "sim/physics/lab_things.hpp"

namespace foresight {
namespace {

constexpr double kSameOutline = 1.5;  // px by which an outline that is found may be off

}  // namespace

std::vector<LooseThing> things_about(const std::filesystem::path& rig_file, const LiveScene& scene, bool physics) {
  std::vector<LooseThing> out = loose_things(rig_file);
  if (!out.empty() || !scene.is_mock() || !physics) return out;
  for (const sim::LooseThing& thing : sim::lab_things()) out.push_back({thing.name, thing.mass, thing.surface, {}});
  return out;
}

ThingsOutlook::ThingsOutlook(const Rig& rig, std::shared_ptr<const LiveScene> scene,
                             const std::vector<LooseThing>& things, bool in_background)
    : rig_(rig), scene_(std::move(scene)), in_background_(in_background) {
  for (const RigJoint& joint : rig.joints)
    if (joint.group == JointGroup::gripper) options_.jaws.push_back(joint.drive.name);
  if (!scene_->model()) return;
  std::vector<SoughtThing> sought;
  for (const LooseThing& thing : things) {
    const auto node = scene_->model()->find(thing.node);
    if (!node) continue;
    nodes_.push_back(static_cast<std::size_t>(*node));
    Eigen::AlignedBox3d box;
    for (const auto& p : scene_->model()->nodes()[nodes_.back()].mesh.vertices) box.extend(p.cast<double>());
    boxes_.push_back(box);
    options_.things.push_back({thing.node, thing.mass, thing.surface});
    sought.push_back({nodes_.back(), thing.tag});
  }
  if (!sought.empty() && scene_->lenses())
    finder_ = std::make_unique<ThingFinder>(scene_->model(), std::move(sought), *scene_->lenses());
}

void ThingsOutlook::advance(const PredictedRobot& robot) {
  if (robot.status == StateStatus::invalid) return;
  if (future_ && future_->time() - robot.time >= kClockJump) begin_anew();
  if (future_ && robot.time <= future_->time()) return;
  const JointPositions by_name = positions_of(rig_, robot.position);
  const JointPositions joints = [&](std::string_view name) { return by_name(shaft_name(rig_, name)); };
  if (!future_) {
    const PartPoses poses = [scene = scene_](const JointPositions& at) {
      return scene->state_at({}, at, StateStatus::predicted).T_world_node;
    };
    future_ = std::make_unique<ThingFuture>(*scene_->model(), poses, options_, robot.time, joints);
  }
  future_->advance(robot.time, joints);
  take_looked();
}

// Where things were told to be was by another clock.
void ThingsOutlook::begin_anew() {
  future_.reset();
  if (look_) look_->is_of_now = false;
}

void ThingsOutlook::saw(const PosedFrame& frame, const JointPositions& joints) {
  take_looked();
  if (!finder_ || !future_) return;
  if (look_) {
    ++counts_.skipped;
    return;
  }
  const JointPositions named = [&rig = rig_, joints](std::string_view name) { return joints(shaft_name(rig, name)); };
  std::vector<ExpectedThing> expected;
  for (std::size_t i = 0; i < future_->size(); ++i) {
    const auto then = future_->at(i, frame.left.time);
    if (!then) return;  // of before all that is remembered
    const PredictedThing now = future_->thing(i);
    expected.push_back(
        {*then, now.held, now.status == ThingStatus::falling, future_->if_still_in_hand(i, frame.left.time, named)});
  }
  ++counts_.looked;
  if (!in_background_) {
    learn(finder_->look(frame, expected), named, frame.left.time, frame.left.T_world_camera);
    return;
  }
  look_.emplace(named, frame.left.time, frame.left.T_world_camera,
                std::async(std::launch::async, [finder = finder_.get(), frame, expected] {
                  make_background();
                  return finder->look(frame, expected);
                }));
}

void ThingsOutlook::take_looked() {
  if (!look_ || look_->found.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const FoundThings found = look_->found.get();
  if (look_->is_of_now) learn(found, look_->joints, look_->captured, look_->T_world_camera);
  look_.reset();
}

/// No corner of the box around it is seen further away than an outline may be off.
bool ThingsOutlook::look_alike(std::size_t thing, const Pose& one, const Pose& other,
                               const Pose& T_world_camera) const {
  const Pose T_camera_world = T_world_camera.inverse();
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner = boxes_[thing].corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
    const auto a = scene_->lenses()->left.project(T_camera_world * one * corner),
               b = scene_->lenses()->left.project(T_camera_world * other * corner);
    if (!a || !b || (*a - *b).norm() > kSameOutline) return false;
  }
  return true;
}

void ThingsOutlook::learn(const FoundThings& found, const JointPositions& joints, RobotTime captured,
                          const Pose& T_world_camera) {
  for (ThingSighting sighting : found.sightings) {
    const auto then = future_->at(sighting.thing, captured);
    if (then && !future_->thing(sighting.thing).held &&
        look_alike(sighting.thing, *then, sighting.T_world_thing, T_world_camera))
      sighting.T_world_thing = *then;
    const SightingResult result = future_->correct(sighting, &joints);
    counts_.taken += result == SightingResult::taken ? 1 : 0;
    counts_.moved += result == SightingResult::moved ? 1 : 0;
    counts_.taken_back += result == SightingResult::taken_back ? 1 : 0;
  }
  for (const std::size_t thing : found.missing) {
    ++counts_.missing;
    future_->absent(thing, captured);
  }
}

void ThingsOutlook::place(SceneState& state) const {
  if (!future_) return;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto then = state.time < future_->time() ? future_->at(i, state.time) : std::nullopt;
    state.T_world_node[nodes_[i]] = then ? *then : future_->thing(i).T_world_thing;
  }
}

std::vector<std::string> ThingsOutlook::names() const {
  std::vector<std::string> out;
  for (const KnownThing& thing : options_.things) out.push_back(thing.node);
  return out;
}

bool ThingsOutlook::seen_at_rest(const std::string& node) const {
  const auto known = std::ranges::find(options_.things, node, &KnownThing::node);
  if (!future_ || known == options_.things.end()) return false;
  return future_->thing(static_cast<std::size_t>(known - options_.things.begin())).status == ThingStatus::seen;
}

std::vector<std::string> ThingsOutlook::lines() const {
  std::vector<std::string> out;
  for (std::size_t i = 0; future_ && i < future_->size(); ++i) {
    const PredictedThing thing = future_->thing(i);
    const std::string& name = options_.things[i].node;
    if (thing.status == ThingStatus::unsure)
      out.push_back(name + (std::isinf(thing.sigma) ? ": not where it was, not found" : ": images show it elsewhere"));
    else if (thing.held)
      out.push_back(fmt::format("{}: in the hand, within {:.0f} mm", name, std::ceil(2e3 * thing.sigma)));
  }
  return out;
}

}  // namespace foresight
