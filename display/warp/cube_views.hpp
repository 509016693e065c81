// Views in all directions around the viewer, which serve on when the head only turns.
//
//        .-------.        a face is drawn when it is seen and is not there yet, or when the viewer has gone too far
//        from
//       /  +y   /|        where it was drawn from; frames are warped from the faces that they see, whichever way the
//      '-------' |+x      head looks. Faces stand still in the world, and are wider than a quarter turn by a guard.
//      |  +z   |/
//      '-------'
//
// (Viewport-independent rendering: Regan and Pose, "Priority Rendering with a Virtual Reality Address Recalculation
// Pipeline", SIGGRAPH 1994; there distant shells are drawn more rarely, here each face is whole.)
#pragma once

#include <optional>

#include "display/warp/depth_warp.hpp"

namespace foresight {

/// Belongs to one context.
class CubeViews {
 public:
  static constexpr int kFaces = 6;
  static constexpr double kGuard = 3 * EIGEN_PI / 180;  ///< rad on each side
  static constexpr double kFarthest = 0.05;             ///< m that a viewer may be from where a face was drawn

  /// Faces as sharp as `target` is in its middle. Throws what DepthWarp does.
  CubeViews(std::shared_ptr<const WarpScene> scene, const Lens& target);

  const Lens& face_lens() const { return face_lens_; }
  /// Where a face's camera is for a viewer there: its middle is the viewer's, its directions are the world's.
  static Pose T_world_face(int face, const Pose& T_world_camera);

  /// The face that is missing most: of those that the camera sees, of which it sees most; nothing where all are there.
  std::optional<int> missing(const Pose& T_world_camera) const;
  /// To be captured into, the view drawn through face_lens() from T_world_face().
  WarpLayers& layers(int face);
  /// What all faces show has changed: they are missing again.
  void forget();

  /// A frame from what is there: DepthWarp::picture().
  const gl::Texture& operator()(const Pose& T_world_camera, std::span<const Pose> T_world_node = {});
  const gl::Texture& holes() const { return warp_.holes(); }

 private:
  std::array<int, kFaces> seen_by(const Pose& T_world_camera) const;

  Lens target_, face_lens_;
  DepthWarp warp_;
  std::array<std::optional<WarpLayers>, kFaces> faces_;
};

}  // namespace foresight
