// Which couples of a robot's links are so near to each other in the chain that their distances are looked up
// (near_links.hpp), and the tables of these.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "motion/near_links.hpp"

namespace foresight {

/// What moves two links of a robot against each other.
struct LinkPath {
  int joints = 0;                     ///< that move, followers too
  bool jaws = true;                   ///< all of them close on things
  std::vector<NearLinks::Axis> axes;  ///< what they follow

  /// Neighbours touch at the joint between them, jaws where they close: all others have to stay apart.
  bool apart() const { return joints >= 2 && !jaws; }
  bool near() const { return axes.size() <= 2; }
};

/// A robot, and which of its joints are moved.
struct MovedRobot {
  const UrdfRobot& robot;
  const std::vector<std::string>& joints;  ///< as PosedLinks takes them
  const std::vector<bool>& jaws;           ///< of these, which close on things
  const PosedLinks& posed;

  LinkPath between(std::size_t link, std::size_t other) const;
};

/// Immutable; any thread.
struct NearCouples {
  struct Couple {
    std::size_t link, other;
    NearLinks apart;
  };
  double clearance = 0;  ///< m, that these were made for
  std::vector<Couple> couples;
  std::vector<std::array<std::size_t, 2>> far;  ///< links that have to stay apart, too, moved by more joints
  std::vector<TriangleTree> bodies;             ///< per link; empty: of no couple
  /// Links of which one's housing is in the other's (NearLinks::nested), by their names.
  std::vector<std::array<std::string, 2>> nested;

  /// What the meshes of a couple are apart, m: for pictures, not for the loop. Does not allocate.
  double distance(const Couple& couple, const PosedLinks& posed) const noexcept;

  /// Made once for all of a process that ask for the same and hold it: a second where meshes are detailed. Of more than
  /// kFineLink triangles they are simplified, to kLinkTolerance. Any thread.
  static std::shared_ptr<const NearCouples> of(const MovedRobot& robot, double clearance);
};

}  // namespace foresight
