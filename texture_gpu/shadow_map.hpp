// What the lamp sees of the scene at one instant.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "gl/raster_pass.hpp"
#include "texture_gpu/lamp/lamp.hpp"

namespace foresight {

/// The lamp, and which parts throw shadows that move.
struct SceneLight {
  Lamp lamp;
  std::vector<bool> moving;  ///< one for each node
  /// Shadows that move have told where it is; else single images have, and they may be some centimetres off.
  bool told_by_what_moves = true;
};

/// One that stands far above the whole scene, in which everything throws a shadow: to run programs with before a lamp
/// is known.
SceneLight light_from_above(const gl::SceneBuffers& scene, const SceneState& state);

/// Depth of what moves and of what stands still, from the middle of the lamp (Williams 1978). One context.
class ShadowMap {
 public:
  explicit ShadowMap(std::shared_ptr<const gl::SceneBuffers> scene);

  /// False where nothing that moves can throw a shadow, or the lamp stands among it: then there is no map.
  bool update(const SceneLight& light, const SceneState& state);

  const Lamp& lamp() const { return lamp_; }
  const Pose& T_world_lamp() const { return T_world_lamp_; }  ///< z towards what moves
  const gl::Faces& faces() const { return moving_.faces; }
  /// Binds three units for shadow.glsl, and sets the lamp's uniforms of `program`, which is in use.
  void bind(const gl::Program& program, GLuint unit) const;

 private:
  /// What a map has to hold.
  struct Reach {
    std::vector<Eigen::Vector3d> moving;  // corners of boxes
    double farthest = 0;                  // m from the lamp, of all
  };
  struct Extent {
    double widest = 0;  // tangent of half the angle
    double rim = 0;     // by which the lamp's rim sees other places than its middle, at most: a part of it
  };
  Reach reach_of(const SceneLight& light, const SceneState& state) const;
  std::optional<Extent> extent_of(const Reach& reach) const;
  bool aim(const SceneLight& light, const SceneState& state);
  void draw_still(const SceneLight& light, const SceneState& state);

  std::shared_ptr<const gl::SceneBuffers> scene_;
  gl::RasterPass raster_;
  gl::Program cells_program_, spread_program_;
  gl::FaceImages moving_, still_;
  gl::Texture cells_, spread_;  // R32F: largest depth value of each cell, and within reach of it
  Lamp lamp_;
  Pose T_world_lamp_;
  double held_ = 0;  // Extent::widest of the map as it is turned; 0: it is not
  std::optional<std::vector<std::optional<Pose>>>
      still_of_;      // where each node was that stood still when that was drawn
  double reach_ = 0;  // px of the map by which the lamp's rim sees other places than its middle, at most
};

}  // namespace foresight
