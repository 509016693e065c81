// Reads a robot from a URDF file and poses its links by forward kinematics.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scene/mesh_finder.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

struct UrdfJoint {
  enum class Kind { fixed, rotating, sliding };
  struct Mimic {
    int joint = -1;  ///< index of the joint that it follows
    double multiplier = 1;
    double offset = 0;  ///< rad or m
  };

  std::string name;
  Kind kind = Kind::fixed;
  bool loose = false;  ///< floating or planar in the file, of which nothing tells the place: counts as fixed
  int child = -1;      ///< index of the link that it moves
  Pose T_parent_joint = Pose::Identity();  ///< parent link to joint frame at position 0
  Eigen::Vector3d axis{1, 0, 0};           ///< unit vector, in the joint frame
  double lower = 0, upper = 0;             ///< rad or m; infinite for a continuous joint
  double velocity = 0;                     ///< largest, rad/s or m/s; 0 where the file says none
  std::optional<Mimic> mimic;
};

struct UrdfRobot {
  std::string name;
  std::vector<Node> links;        ///< parents first; link 0 is the root, with parent -1
  std::vector<UrdfJoint> joints;  ///< joint i moves link i + 1
  /// Of each link, all its collision shapes as one mesh, without vertices where it has none. Only with UrdfShapes::all.
  std::vector<Mesh> collision;

  /// The shape that a link is kept clear by: its collision shapes where it has any, else its visual ones; without
  /// vertices where it has neither.
  const Mesh& body(std::size_t link) const {
    return link < collision.size() && !collision[link].vertices.empty() ? collision[link] : links[link].mesh;
  }
};

/// What a robot is read for: its joints alone (then links are empty, and missing meshes no error), to be seen, or to be
/// kept clear of things, too.
enum class UrdfShapes { none, visual, all };

/// Reads links, joints and geometry: meshes (with their scale), boxes, cylinders and spheres; all visuals of a link
/// become its one mesh. Every <visual> and <collision> yields its shape, or the file is refused as check_urdf() does;
/// with UrdfShapes::all, also where a link's body is smaller than 1 mm or larger than 20 m: its unit is another one.
/// Meshes are looked for as find_mesh() says. Links stand at joint positions 0. Floating and planar joints count as
/// fixed. Throws InputError naming the file and the link or joint: not a URDF, no single tree, a missing mesh, a size
/// or axis that is no such thing.
UrdfRobot read_urdf(const std::filesystem::path& file, const MeshSearch& search = {},
                    UrdfShapes shapes = UrdfShapes::visual);
/// The same of a run folder: meshes lie in the folder of the URDF or in those above it, up to `root`.
UrdfRobot read_urdf(const std::filesystem::path& file, const std::filesystem::path& root,
                    UrdfShapes shapes = UrdfShapes::visual);

/// Joint positions in rad or m, by name. Sets T_parent_node of all links but the root. Joints
/// that are not named stand at 0 or their nearest limit; mimic joints follow theirs. Throws
/// InputError at `where`: an unknown joint (with the nearest name), one that is fixed or follows
/// another, a position outside of the limits or not finite.
void pose_links(UrdfRobot& robot, const std::map<std::string, double>& positions, const std::string& where);

/// Where a joint stands: factor * position of `joint` + offset, in rad or m.
struct JointSource {
  int joint = -1;  ///< one that follows no other: the joint itself, or the last of those that it follows
  double factor = 1;
  double offset = 0;
};

/// What joint `index` of the robot follows; read_urdf has refused circles.
JointSource source_of(const UrdfRobot& robot, std::size_t index);

/// T_joint_child at `position` rad or m. Does not allocate.
Pose joint_transform(const UrdfJoint& joint, double position) noexcept;

}  // namespace foresight
