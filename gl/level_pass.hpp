// Rasterises a scene with each node at a level of its own.
#pragma once

#include <array>
#include <optional>

#include "gl/level_buffers.hpp"
#include "gl/raster_pass.hpp"
#include "scene/lod/level_director.hpp"

namespace foresight::gl {

/// What a view may show.
struct SeenNodes {
  std::vector<std::vector<bool>> on_face;  ///< for each face, for each node
  std::vector<bool> anywhere;              ///< for each node
};

/// As RasterPass, with surface, by the plan of a LevelDirector. Where a coarser level is seen, the surface is a
/// triangle of the same part as what is seen there, and the plane is that of the level itself. Belongs to the context
/// it was built in.
class LevelPass {
 public:
  explicit LevelPass(std::shared_ptr<const LevelBuffers> levels);

  void leave_out(LeavesOut what) { leaves_out_ = what; }
  /// From now on only this part is drawn; nothing: all of it. The textures must outlive that.
  void draw_part(const std::optional<ViewPart>& part) { part_ = part; }
  /// What faces of a camera there may show.
  SeenNodes seen_from(const Pose& T_world_camera, const SceneState& state, const Faces& faces) const;

  /// Fills `target`, which has surfaces and may have planes, with nodes as in `plan`; `seen`: seen_from() there. Leaves
  /// framebuffer 0 bound and depth test off.
  void operator()(const Pose& T_world_camera, const SceneState& state, const LevelPlan& plan, const SeenNodes& seen,
                  const FaceImages& target) const;
  /// That the last call gave to the GPU, on all faces.
  std::size_t triangles() const { return triangles_; }

 private:
  struct Programs {
    Programs(bool planes, bool part);
    Program whole, faded;
  };
  const Programs& programs(bool planes) const;
  void start_face(int face, const FaceImages& target) const;
  void draw_node(std::size_t node, const Pose& T_face_node, const LevelPlan& plan, const Programs& programs) const;
  void draw_level(std::size_t node, int level, const Program& program) const;

  std::shared_ptr<const LevelBuffers> levels_;
  VertexArray array_;
  Framebuffer framebuffer_;
  KeptFences fences_;
  mutable std::array<std::optional<Programs>, 4> programs_;  // with planes, of a part, both; from the first use on
  std::optional<ViewPart> part_;
  LeavesOut leaves_out_ = LeavesOut::behind_walls;
  mutable std::size_t triangles_ = 0;
};

}  // namespace foresight::gl
