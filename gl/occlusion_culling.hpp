// Which nodes are hidden by what has been drawn already, found and heeded on the GPU.
//
//   nodes that were seen last time --> drawn --> farthest depth of tiles --> boxes of all nodes against it
//                                                                             |             |
//                        next time's first <-- a while later, nobody waits <--'             '--> the others that may be
//                                                                                                seen are drawn now
//
// Whatever was seen last time, in whatever view, the picture is the same; only who is drawn first is guessed from it.
// (Coherent hierarchical culling after Greene, Kass, Miller: "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993.)
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gl/faces.hpp"
#include "gl/program.hpp"
#include "gl/scene_buffers.hpp"

namespace foresight::gl {

/// For one face, time after time. Belongs to one context.
class OcclusionCulling {
 public:
  explicit OcclusionCulling(std::shared_ptr<const SceneBuffers> scene);

  /// Of `seen`, an entry for each node, those to be drawn before judge().
  std::vector<bool> first(const std::vector<bool>& seen);
  /// These have been drawn into layer `layer` of `depth` (FaceImages::depth): judges all of `seen`, and prepares
  /// draw().
  void judge(const Faces& faces, GLuint depth, int layer, const Pose& T_face_world, const SceneState& state,
             const std::vector<bool>& seen, const std::vector<bool>& drawn);
  /// Draws the scene's range of that index, of a node that was not drawn yet, where it may be seen: with the scene's
  /// vertex array and a program in use.
  void draw(std::size_t range) const;
  /// That draw() gave to the GPU since judge(). Waits for it.
  std::size_t triangles() const;

 private:
  std::shared_ptr<const SceneBuffers> scene_;
  Program farthest_, judge_;
  std::array<Texture, 2> tiles_;  // R32F: least near / z of 8 x 8 px; of 8 x 8 of these
  Buffer boxes_, commands_, visible_;
  Fence judged_;
  bool is_judged_ = false;
  std::vector<bool> seen_last_;  // as far as that is known
};

}  // namespace foresight::gl
