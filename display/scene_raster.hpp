// Rasterises the scene for a view: in full, or each node at the level that the view needs of it.
#pragma once

#include <memory>
#include <optional>

#include "gl/level_pass.hpp"
#include "gl/pass_timer.hpp"
#include "scene/lod/motion_levels.hpp"

namespace foresight {

/// How a view simplifies what it draws.
struct ViewLevels {
  std::shared_ptr<const gl::LevelBuffers> buffers;
  LevelSettings settings;
};

/// Belongs to one context and one view, whose frames follow each other.
class SceneRaster {
 public:
  /// Without `levels`, in full.
  SceneRaster(std::shared_ptr<const gl::SceneBuffers> scene, const std::optional<ViewLevels>& levels);

  bool has_levels() const { return levels_.has_value(); }
  /// Of the faces that it draws into: what shaders read depends on it.
  gl::FaceImages make_faces(const gl::Faces& faces) const { return {faces, true, has_levels()}; }

  /// From now on only this part is drawn; nothing: all of it. Of what another view hides, that view's levels are drawn:
  /// it is drawn before, from the same place. The textures must outlive that.
  void draw_part(const std::optional<gl::ViewPart>& part);
  /// `state` as a view from there shows it: with levels, what moves too little to be seen stands where it was
  /// (scene/lod/motion_levels.hpp), so that a robot at rest is at rest however its encoders tremble. Valid until the
  /// next call.
  const SceneState& shown(const Pose& T_world_camera, const SceneState& state, const gl::Faces& faces);
  /// Fills `target` as seen from T_world_camera (gl::RasterPass, gl::LevelPass). The budget counts the time of this
  /// alone; transitions go by the state's time.
  void operator()(const Pose& T_world_camera, const SceneState& state, const gl::FaceImages& target);

  /// Null without levels.
  const LevelDirector* director() const { return levels_ ? &levels_->director : nullptr; }

 private:
  struct Levels {
    explicit Levels(const ViewLevels& levels);
    gl::LevelPass pass;
    LevelDirector director;
    MotionLevels motion;
    SceneState shown;
    gl::PassTimer timer;
    FrameWork timed;  // what the timer measures
  };
  std::optional<gl::RasterPass> whole_;
  std::optional<Levels> levels_;
  bool follows_ = false;  // a view that was drawn: what that hides
};

}  // namespace foresight
