// One rigid part in the form in which contact is looked for: FCL's tree of turned boxes for what touches (Gottschalk,
// Lin, Manocha, OBB-tree, SIGGRAPH 1996), and one of boxes along the part's axes for what is near (triangle_tree).
//
// A part is a surface, not a solid: what is wholly inside of a closed part touches nothing.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

using TrianglePair = std::array<int, 2>;  ///< one of each part

struct MeshNearest {
  double distance = 0;                 ///< m; 0: they touch
  Eigen::Vector3d point, other_point;  ///< world
  TrianglePair triangles{-1, -1};
};

/// Immutable; any thread.
class ContactMesh {
 public:
  /// Triangles without area, or with a vertex that is not finite or does not exist, are left out.
  explicit ContactMesh(const Mesh& mesh);
  ~ContactMesh();
  ContactMesh(ContactMesh&&) noexcept;
  ContactMesh& operator=(ContactMesh&&) noexcept;

  std::size_t triangles() const noexcept { return triangles_; }
  std::size_t left_out() const noexcept { return left_out_; }
  /// In the part's frame.
  const Eigen::AlignedBox3d& box() const noexcept { return box_; }
  /// Of a ball around it, whose centre is the box's.
  double radius() const noexcept { return radius_; }
  Eigen::Vector3d normal(int triangle) const;  ///< unit, in the part's frame

  /// Do surfaces meet? Poses are T_world_part; both have triangles.
  static bool touch(const ContactMesh& one, const Pose& T_one, const ContactMesh& other, const Pose& T_other);
  /// Triangles that cross, `most` of them.
  static std::vector<TrianglePair> crossing(const ContactMesh& one, const Pose& T_one, const ContactMesh& other,
                                            const Pose& T_other, std::size_t most);
  /// The nearest points of both, where these are nearer than `within`. `hint`: triangles that may be nearest, such as
  /// those of the last picture; it changes how long this takes, and no bit of the answer.
  static std::optional<MeshNearest> nearest(const ContactMesh& one, const Pose& T_one, const ContactMesh& other,
                                            const Pose& T_other, double within, const TrianglePair& hint = {-1, -1});

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
  std::size_t triangles_ = 0, left_out_ = 0;
  Eigen::AlignedBox3d box_;
  double radius_ = 0;
};

}  // namespace foresight
