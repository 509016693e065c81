// Views in all directions around the viewer, which serve on when the head only turns.
//
//        .-------.        a face is drawn when it is seen and is not there yet, or when the viewer has gone too far
//        from
//       /  +y   /|        where it was drawn from; frames are warped from the faces that they see, whichever way the
//      '-------' |+x      head looks. Faces stand still in the world, and are wider than a quarter turn by a guard.
//      |  +z   |/
//      '-------'
//
// Each face may be cut into shells of distance: cubes around the viewer, too. What is far away looks the same for
// longer, so a shell's faces serve the longer the farther it is, and are drawn anew more rarely when what they show
// changes. A frame is put together of all of them, the nearest surface at each pixel. What a near shell hides, a
// farther one knows.
//
// (Viewport-independent rendering in prioritised shells: Regan and Pose, "Priority Rendering with a Virtual Reality
// Address Recalculation Pipeline", SIGGRAPH 1994.)
#pragma once

#include <optional>

#include "display/warp/depth_warp.hpp"

namespace foresight {

/// Belongs to one context.
class CubeViews {
 public:
  static constexpr int kFaces = 6;
  static constexpr double kGuard = 3 * EIGEN_PI / 180;  ///< rad on each side
  static constexpr double kFarthest = 0.05;             ///< m that a viewer may be from where the nearest was drawn
  static constexpr double kShare = 0.125;               ///< of the distance of what a face shows nearest, likewise
  static constexpr double kNear = kFarthest / kShare;   ///< m: as near as surfaces usually are
  static constexpr double kNearestBorder = 0.3;         ///< m

  /// A shell's picture in one direction.
  struct Face {
    int side = 0;           ///< of the cube
    std::size_t shell = 0;  ///< from near to far
  };

  /// Faces as sharp as `target` is in its middle. `borders`: m, between shells, ascending; empty: one shell. Throws
  /// std::invalid_argument: borders that do not ascend, or that are nearer than kNearestBorder.
  CubeViews(std::shared_ptr<const WarpScene> scene, const Lens& target, std::vector<double> borders = {});

  const Lens& face_lens() const { return face_lens_; }
  std::size_t shells() const { return borders_.size() + 1; }
  /// Where a face's camera is for a viewer there: its middle is the viewer's, its directions are the world's.
  static Pose T_world_face(int side, const Pose& T_world_camera);
  /// What is drawn of a shell: its own distances, and as much nearer as the shells' middles may be apart.
  gl::ViewPart part(std::size_t shell) const;
  /// m that a viewer may be from where a face of the shell was drawn, unless that shows something nearer than kNear.
  double may_move(std::size_t shell) const;

  /// The face that is missing most: of the nearest shell that misses one, that of which the camera sees most; nothing
  /// where all are there. Waits for faces that were drawn since: how near what they show is decides how long they
  /// serve.
  std::optional<Face> missing(const Pose& T_world_camera);
  /// To be captured into, the shell's part of the view drawn through face_lens() from T_world_face().
  WarpLayers& layers(const Face& face);
  /// What all faces show has changed, as with a new image: those of the nearest shell are missing again, those of the
  /// next one with every second call, of the next with every fourth, and so on. Frames show the old ones until then.
  void changed();
  /// All are missing again.
  void forget();

  /// A frame from what is there: DepthWarp::picture().
  const gl::Texture& operator()(const Pose& T_world_camera, std::span<const Pose> T_world_node = {});
  const gl::Texture& holes() const { return warp_.holes(); }

 private:
  std::array<int, kFaces> seen_by(const Pose& T_world_camera) const;

  Lens target_, face_lens_;
  std::vector<double> borders_;
  DepthWarp warp_;
  struct Kept {
    std::optional<WarpLayers> layers;
    bool is_new = false;            // shows what is
    std::optional<double> nearest;  // m, that it shows; nothing: not known yet
  };
  bool serves(Kept& face, std::size_t shell, const Pose& T_world_camera) const;
  std::vector<std::array<Kept, kFaces>> shells_;
  unsigned changes_ = 0;
};

}  // namespace foresight
