// What of a robot, of what it carries and of the scene touches, and what is about to: triangle by triangle.
//
//   pose(joints, nodes) once a picture --> touching()            which couples of parts touch
//                                          near(0.05), least()   distances, nearest points, the direction between them
//                                          penetration(couple)   how deep, and the shortest way out
//
// The safety gate keeps capsules around links apart (motion/robot_shape); this is the finer check of what is shown.
// Answers do not depend on what was asked before, bit for bit: what is remembered only makes them come sooner.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motion/posed_links.hpp"
#include "prediction/contact/contact_mesh.hpp"

namespace foresight {

inline constexpr double kContactReach = 0.05;  ///< m: how far the display is interested in distances

/// Two parts that may meet, and how far apart they are. Of a couple, `one` is always of the robot or carried.
struct Nearness {
  std::size_t couple = 0;              ///< index, until attach() or detach()
  double distance = 0;                 ///< m; 0: they touch
  Eigen::Vector3d point, other_point;  ///< the nearest points, world
  Eigen::Vector3d direction{0, 0, 0};  ///< unit, from the other part to this; 0 where they touch
};

/// How deep one part of a couple is in the other: by how far it must be shifted, along a normal of one of the triangles
/// that cross, until nothing touches. The shortest way along all directions may be shorter still.
struct Penetration {
  double depth = 0;  ///< m, to 0.01 mm; at most kDeepest
  Eigen::Vector3d direction{0, 0,
                            0};  ///< unit, world: the way out for the couple's first part; 0: none within kDeepest
};
inline constexpr double kDeepest = 0.1;

/// One thread. Allocates.
class ContactModel {
 public:
  /// `joints`: those whose positions pose() gets (as PosedLinks takes them, with `where`). Links are the robot's bodies
  /// (UrdfRobot::body); nodes of `scene` (null: nothing) that have a link's name are that link, and left to the robot.
  /// Left out are couples that no joint, or only one, can move against each other, links that stand and nodes, and
  /// couples that overlap wherever the joints are (as the gate's covers of neighbours do; here by 64 seeded positions,
  /// with the scene at rest). Throws InputError as PosedLinks, and where no link has a shape.
  ContactModel(const UrdfRobot& robot, const std::vector<std::string>& joints, const SceneModel* scene,
               const Pose& T_world_root, const std::string& where);

  std::size_t joints() const noexcept { return links_.inputs(); }
  const PosedLinks& links() const noexcept { return links_; }
  std::size_t couples() const noexcept { return couples_.size(); }
  /// Grows whenever couples get other indices.
  std::size_t arrangement() const noexcept { return arrangement_; }
  /// Names of both parts.
  const std::string& name(std::size_t couple) const { return parts_[couples_[couple].one].name; }
  const std::string& other_name(std::size_t couple) const { return parts_[couples_[couple].other].name; }
  /// The same as indices, less than parts().
  std::array<std::size_t, 2> parts_of(std::size_t couple) const {
    return {couples_[couple].one, couples_[couple].other};
  }
  std::size_t parts() const noexcept { return parts_.size(); }
  const std::string& part_name(std::size_t part) const { return parts_[part].name; }
  /// Where it stands, as of the last pose().
  const Pose& T_world_part(std::size_t part) const { return parts_[part].T_world; }
  /// Couples that overlap wherever the joints are, such as "arm_1 and table".
  const std::vector<std::string>& always_overlapping() const noexcept { return always_; }
  /// What is not as it might be expected, in words: links without a shape, triangles without area; empty: nothing.
  const std::vector<std::string>& remarks() const noexcept { return remarks_; }

  /// Node `node` of the scene moves with `link` from now on, T_link_node from it, and is part of the robot. It may
  /// touch that link, all that hangs on it, and `holding`: the fingers. Throws std::invalid_argument where there is no
  /// such node with triangles, no such link, or a pose that is none.
  void attach(std::size_t node, std::size_t link, const Pose& T_link_node, std::span<const std::size_t> holding = {});
  /// It is of the scene again. Nothing where it was not attached.
  void detach(std::size_t node);

  /// All that is asked next is of these positions, and T_world_node of every node; no nodes: at rest. Returns nullptr,
  /// or what is wrong with them in words: then valid() is false, and nothing touches or is near.
  const char* pose(std::span<const double> positions, std::span<const Pose> T_world_node = {});
  /// The same with the nodes as they are.
  const char* move(std::span<const double> positions);
  bool valid() const noexcept { return valid_; }

  std::vector<std::size_t> touching() const;
  /// Couples nearer than `within`, the nearest first.
  std::vector<Nearness> near(double within = kContactReach);
  /// The first of them: asking for it alone is cheaper.
  std::optional<Nearness> least(double within = kContactReach);
  Penetration penetration(std::size_t couple) const;

  /// Change of a couple's distance per change of each joint, m per rad or m: as if `nearness`'s points stayed on their
  /// parts and their direction stayed; `direction` in place of its own where they touch.
  std::vector<double> change_of(const Nearness& nearness, const Eigen::Vector3d& direction) const;
  /// The parts of a couple cannot get farther against each other than this, m, while the joints go evenly by `change`.
  double farthest(std::size_t couple, std::span<const double> change) const noexcept;

  /// The same of all couples at once, m.
  double farthest(std::span<const double> change) const;

  /// Forgets what makes answers come sooner, as a new model does.
  void forget() noexcept;

 private:
  struct Part {
    std::string name;
    ContactMesh mesh;
    int link = -1, node = -1;             // a carried node has both
    Pose T_link_part = Pose::Identity();  // of what moves with a link
    std::vector<std::size_t> holding;
    Pose T_world = Pose::Identity();
    Eigen::AlignedBox3d box;          // world
    Eigen::Vector3d center{0, 0, 0};  // world
  };
  struct Couple {
    std::size_t one, other;
    std::vector<std::size_t> path, other_path;  // joints that move them against each other
    TrianglePair hint{-1, -1};
  };

  void add_part(std::string name, const Mesh& mesh, int link, int node);
  void make_couples();
  bool holds(const Part& holder, const Part& carried) const;
  Couple couple_of(std::size_t one, std::size_t other) const;
  void leave_out_what_always_overlaps(const UrdfRobot& robot, const std::vector<std::string>& joints);
  void place();
  double at_least(const Couple& couple) const;
  std::optional<Nearness> nearest(std::size_t couple, double within);
  bool touch(const Couple& couple) const;

  PosedLinks links_;
  std::vector<Pose> T_world_node_, T_world_rest_;
  std::vector<Part> parts_;
  std::vector<Couple> couples_;
  std::vector<std::array<std::size_t, 2>> left_out_;
  std::vector<std::string> always_, remarks_;
  std::size_t arrangement_ = 0;
  bool valid_ = false;
};

}  // namespace foresight
