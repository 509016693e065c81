// Rasterises the scene into the faces of a camera: depth only, or depth and surface.
#pragma once

#include <limits>
#include <optional>

#include "gl/faces.hpp"
#include "gl/kept_fences.hpp"
#include "gl/occlusion_culling.hpp"
#include "gl/program.hpp"
#include "gl/scene_buffers.hpp"

namespace foresight::gl {

/// What the pass draws into. Layers are faces.
struct FaceImages {
  /// `with_surface`: also hold the triangle seen at each pixel; `with_planes`: and the plane that it lies in.
  FaceImages(const Faces& faces, bool with_surface, bool with_planes = false);

  Faces faces;
  Texture depth;    ///< DEPTH_COMPONENT32F array: kNearPlane / z at the pixel's centre, 0 = no model
  Texture surface;  ///< R32UI array: scene triangle index + 1, 0 = no model; empty without surface
  Texture planes;   ///< RGBA32F array: unit normal n in the node's frame and n p of its points; undefined without model
};

/// A part of what a camera sees.
struct ViewPart {
  double nearest = 0;                                         ///< m along the camera's axis: from here on
  double farthest = std::numeric_limits<double>::infinity();  ///< up to here, itself left out
  /// What another view of one face hides near edges: only surfaces that face the camera, clearly farther than what that
  /// view shows. 1 / z in 1/m at each pixel, 0 where no model is; 0: no such view.
  GLuint seen = 0;
  /// With it, of each 8 x 8 px of the face: the least of `seen` around in green, and not 0 in blue where an edge is
  /// near.
  GLuint edges = 0;
};

/// For a program with view_part.glsl: sets it, and binds its textures.
void use_part(const Program& program, const ViewPart& part);

/// What a pass does not draw. Whatever is left out is at no pixel. Each leaves out what those before do.
enum class LeavesOut { nothing, out_of_view, behind_walls, hidden };

/// For each node, whether a face from there may show it. What other nodes hide is not judged. `cells`: of the scene, or
/// null.
std::vector<bool> seen_nodes(const Pose& T_world_face, const Faces& faces, const NodeBoxes& boxes,
                             const CellGraph* cells, const SceneState& state, LeavesOut leaves_out);

/// Draws the nodes of the scene at the poses of one state, but for those that are out of view, or hidden by the walls
/// of cells, or, of large scenes, by whatever is before them. Of solid bodies only what faces the camera is drawn.
/// Belongs to the context it was built in.
class RasterPass {
 public:
  /// `with_surface` as in the FaceImages that it will draw into.
  RasterPass(std::shared_ptr<const SceneBuffers> scene, bool with_surface);

  /// The last of them is the default where there is so much that it pays, else the one before.
  using LeavesOut = gl::LeavesOut;
  static constexpr std::size_t kMany = 500'000;  ///< triangles
  void leave_out(LeavesOut what) { leaves_out_ = what; }
  /// From now on only this part is drawn; nothing: all of it. Only with surfaces. The textures must outlive that.
  void draw_part(const std::optional<ViewPart>& part);
  /// From now on only these nodes are drawn, one entry for each of the model.
  void draw_only(std::vector<bool> nodes) { only_ = std::move(nodes); }

  /// Fills `target` as seen from T_world_camera. `depth_copy`: R32F array that gets the depth, too; only without
  /// surfaces. Leaves framebuffer 0 bound, depth test and culling of faces off.
  void operator()(const Pose& T_world_camera, const SceneState& state, const FaceImages& target,
                  const Texture* depth_copy = nullptr) const;
  /// That the last call gave to the GPU, on all faces. Waits for it where the GPU decided.
  std::size_t triangles() const;

 private:
  const Program& choose_program() const;
  void set_node(const Program& program, const Pose& T_face_world, const SceneState& state,
                const SceneBuffers::NodeRange& range) const;
  void draw(const Program& program, const Pose& T_face_world, const SceneState& state,
            const std::vector<bool>& nodes) const;
  void draw_unhidden(const Program& program, const FaceImages& target, int face, const Pose& T_face_world,
                     const SceneState& state, const std::vector<bool>& seen) const;
  std::vector<bool> wanted(std::vector<bool> nodes) const;

  std::shared_ptr<const SceneBuffers> scene_;
  VertexArray array_;
  Program program_;
  Program part_program_;  // from the first draw_part() on
  std::optional<ViewPart> part_;
  Framebuffer framebuffer_;
  KeptFences fences_;
  bool with_surface_;
  LeavesOut leaves_out_;
  std::vector<bool> only_;  // empty: all
  mutable std::size_t triangles_ = 0;
  mutable std::vector<OcclusionCulling> culling_;  // of each face, once it is needed
  mutable std::size_t culled_faces_ = 0;           // of the last call
};

}  // namespace foresight::gl
