#include "display/scene_raster.hpp"

#include <algorithm>

#include "gl/context.hpp"

namespace foresight {
namespace {

constexpr double kHeld = 0.5;  // of a level's error: what moves less stands still

}  // namespace

SceneRaster::Levels::Levels(const ViewLevels& levels)
    : pass(levels.buffers),
      director(levels.buffers->levels(), levels.settings),
      motion(levels.buffers->levels()->boxes(),
             {.px = kHeld * levels.settings.px, .eye_looks_ahead = levels.settings.looks_ahead()}),
      timer(gl::query_driver().is_software) {}

SceneRaster::SceneRaster(std::shared_ptr<const gl::SceneBuffers> scene, const std::optional<ViewLevels>& levels) {
  if (levels)
    levels_.emplace(*levels);
  else
    whole_.emplace(std::move(scene), true);
}

const SceneState& SceneRaster::shown(const Pose& T_world_camera, const SceneState& state, const gl::Faces& faces) {
  if (!levels_) return state;
  levels_->shown = levels_->motion.shown(state, {T_world_camera, std::max(faces.fx, faces.fy)});
  return levels_->shown;
}

void SceneRaster::draw_part(const std::optional<gl::ViewPart>& part) {
  follows_ = part && part->seen;
  if (whole_) return whole_->draw_part(part);
  levels_->pass.draw_part(part);
}

void SceneRaster::operator()(const Pose& T_world_camera, const SceneState& state, const gl::FaceImages& target) {
  if (whole_) return (*whole_)(T_world_camera, state, target);
  Levels& levels = *levels_;
  const gl::SeenNodes seen = levels.pass.seen_from(T_world_camera, state, target.faces);
  if (follows_) return levels.pass(T_world_camera, state, levels.director.last(), seen, target);
  if (const auto ms = levels.timer.take()) levels.director.took(levels.timed, *ms);
  const bool timed = levels.timer.begin();
  const double focal_px = std::max(target.faces.fx, target.faces.fy);
  const LevelPlan& plan =
      levels.director.plan({T_world_camera, focal_px, 1e-9 * static_cast<double>(state.time.ns)}, state, seen.anywhere);
  levels.pass(T_world_camera, state, plan, seen, target);
  if (!timed) return;
  levels.timer.end();
  levels.timed = plan.work;
}

}  // namespace foresight
