// Rasterises the scene into the faces of a camera: depth only, or depth and surface.
#pragma once

#include "gl/faces.hpp"
#include "gl/program.hpp"
#include "gl/scene_buffers.hpp"

namespace foresight::gl {

/// What the pass draws into. Layers are faces.
struct FaceImages {
  /// `with_surface`: also hold the triangle seen at each pixel.
  FaceImages(const Faces& faces, bool with_surface);

  Faces faces;
  Texture depth;    ///< DEPTH_COMPONENT32F array: kNearPlane / z at the pixel's centre, 0 = no model
  Texture surface;  ///< R32UI array: scene triangle index + 1, 0 = no model; empty without surface
};

/// Draws the nodes of the scene at the poses of one state, but for those that are out of view, or hidden by the walls
/// of cells. Belongs to the context it was built in.
class RasterPass {
 public:
  /// `with_surface` as in the FaceImages that it will draw into.
  RasterPass(std::shared_ptr<const SceneBuffers> scene, bool with_surface);

  /// Whatever is left out is at no pixel.
  enum class LeavesOut { nothing, out_of_view, behind_walls };
  void leave_out(LeavesOut what) { leaves_out_ = what; }
  /// From now on only these nodes are drawn, one entry for each of the model.
  void draw_only(std::vector<bool> nodes) { only_ = std::move(nodes); }

  /// Fills `target` as seen from T_world_camera. Leaves framebuffer 0 bound and depth test off.
  void operator()(const Pose& T_world_camera, const SceneState& state, const FaceImages& target) const;
  /// That the last call gave to the GPU, on all faces.
  std::size_t triangles() const { return triangles_; }

 private:
  std::vector<bool> seen_from(const Pose& T_world_face, const Faces& faces, const SceneState& state) const;

  std::shared_ptr<const SceneBuffers> scene_;
  VertexArray array_;
  Program program_;
  Framebuffer framebuffer_;
  bool with_surface_;
  std::vector<bool> only_;  // empty: all
  LeavesOut leaves_out_ = LeavesOut::behind_walls;
  mutable std::size_t triangles_ = 0;
};

}  // namespace foresight::gl
