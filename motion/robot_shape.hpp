// Where the links of a robot are, as capsules, and whether they touch what they must not touch.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motion/near_couples.hpp"
#include "motion/posed_links.hpp"
#include "scene/urdf_reader.hpp"

namespace foresight {

/// All points within `radius` of the segment from a to b, metres.
struct Capsule {
  Eigen::Vector3d a, b;
  double radius = 0;
};

/// Least distance between two capsules' surfaces, metres; negative where they overlap.
double distance(const Capsule& one, const Capsule& other);

/// Least distance between a capsule's surface and a box, metres, never too large: the segment is sampled, and half of
/// a step is taken off. Negative where they overlap, the more the deeper.
double distance(const Capsule& capsule, const Eigen::AlignedBox3d& box);

/// What the gate takes a link for.
struct GuardedLink {
  std::string name;
  Capsule body;  ///< world
  bool moves = false;
};

struct Obstacle {
  std::string name;
  Eigen::AlignedBox3d box;
};

/// Where the links may be. World frame, metres.
struct Surroundings {
  Eigen::AlignedBox3d workspace;    ///< no link that moves leaves it; empty: anywhere
  std::vector<Obstacle> obstacles;  ///< tables, walls, the stand
  double clearance = 0.02;          ///< kept from obstacles and between links; > 0
};

/// Which links of a robot can be kept clear of things, and by what.
struct GuardedLinks {
  std::size_t links = 0;               ///< all of them
  std::size_t by_collision = 0;        ///< by their collision shapes
  std::size_t by_visual = 0;           ///< that have no collision shape: by their visual ones
  std::vector<std::string> unguarded;  ///< without any shape, as mere frames are
};
GuardedLinks guarded_links(const UrdfRobot& robot);
/// "11 of 11 links guarded (9 by collision shapes, 2 by visual ones)"; names those without a shape.
std::string to_text(const GuardedLinks& guarded);

/// A robot's links: as capsules around their meshes (UrdfRobot::body), but against links that one or two joints move
/// against them, as the meshes are (near_links.hpp). Thread: one at a time.
class RobotShape {
 public:
  /// `joints`: those whose positions obstructed() gets; they and `where` as PosedLinks takes them. `jaws`: which of
  /// them close on things; links that only these move against each other may touch. `clearance`: until it is
  /// told another one, for which tables would have to be made again.
  RobotShape(UrdfRobot robot, const std::vector<std::string>& joints, const Pose& T_world_root,
             const std::string& where, std::vector<bool> jaws = {}, double clearance = Surroundings{}.clearance);

  /// What it must stay clear of from now on; of a new shape, only its own links. Allocates; takes longer where the
  /// clearance is another one (NearCouples::of).
  void surround(const Surroundings& surroundings);

  /// How many couples of parts must stay apart: links and the workspace's walls, links and obstacles, links and other
  /// links. Neighbours, with one joint that moves between them, are not compared: they touch at that joint.
  std::size_t couples() const { return couples_.size(); }
  /// Two joints away from each other and nearer than 4 mm in half of all positions, as the housings of a compact wrist
  /// are: not compared either. Names of both links.
  const std::vector<std::array<std::string, 2>>& nested() const { return near_->nested; }
  /// Of each couple, by how much it is farther apart than it must be, metres; negative: too close. `out`: couples() of
  /// them. Does not allocate.
  void margins(std::span<const double> positions, std::span<double> out) noexcept;
  /// The same for pictures: of near links that are clear, no lower bound (NearLinks::margin) but what their meshes are
  /// apart. A hundred times the cost.
  void margins_by_meshes(std::span<const double> positions, std::span<double> out) noexcept;
  /// The couple whose parts are too close by the most: the least of the margins, where that is negative. A fraction of
  /// their cost. Does not allocate.
  std::optional<std::size_t> too_close(std::span<const double> positions) noexcept;
  /// Both parts of a couple in words, such as "link 'arm_5' leaves the workspace"; valid until the next surround().
  const char* message(std::size_t couple) const { return couples_[couple].message.c_str(); }
  /// How far apart its parts must be, metres; 0 from the workspace's walls.
  double kept_apart(std::size_t couple) const { return couples_[couple].kept; }

  /// The links that have a body, as they stand there. Allocates: for pictures, not for the loop.
  std::vector<GuardedLink> guarded(std::span<const double> positions);

  /// What keeps the robot from standing there, as message(); nullptr where nothing does. Does not allocate.
  const char* obstructed(std::span<const double> positions) noexcept;

 private:
  struct Link {
    Capsule body;  ///< in the link's frame
    bool has_body = false, moves = false;
  };
  struct Ball {
    Eigen::Vector3d middle;
    double radius = 0;
  };
  enum class Against : std::uint8_t { workspace, obstacle, link, near_link };
  struct Couple {
    Against what;
    std::size_t link, other;  ///< `other`: index of the obstacle, the link, or into near_->couples
    double kept = 0;          ///< m
    std::string message;
  };
  void pose(std::span<const double> positions) noexcept;
  double margin(const Couple& couple) const noexcept;
  bool surely_clear(const Couple& couple) const noexcept;

  UrdfRobot robot_;
  std::vector<std::string> joints_;
  std::vector<bool> jaws_;
  PosedLinks posed_;
  std::vector<double> positions_;
  std::vector<Link> links_;
  std::vector<Capsule> placed_;
  std::vector<Ball> around_;  // each of these
  Surroundings surroundings_;
  std::shared_ptr<const NearCouples> near_;
  std::vector<Couple> couples_;
};

}  // namespace foresight
