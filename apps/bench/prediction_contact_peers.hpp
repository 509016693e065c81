// FCL and Bullet as their manuals use them, to compare with.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "prediction/contact/contact_model.hpp"

namespace foresight {

using PartPair = std::array<std::size_t, 2>;

class ContactPeer {
 public:
  virtual ~ContactPeer() = default;
  virtual void place(const std::vector<Pose>& T_world_part) = 0;
  /// Which of the pairs touch, in any order.
  virtual std::vector<PartPair> touching() = 0;
  /// The least distance of each pair that is within `within` metres.
  virtual std::vector<double> distances(double within) = 0;
  /// The least of them; nothing where none is.
  virtual std::optional<double> least(double within) = 0;
};

/// Two dynamic trees of boxes, robot and scene, over models of triangles (OBBRSS); the pairs that its callbacks let
/// through are `pairs`. `robot`: of each part, does it belong to the robot?
std::unique_ptr<ContactPeer> make_fcl_peer(const std::vector<const Mesh*>& meshes, const std::vector<bool>& robot,
                                           const std::vector<PartPair>& pairs);
/// Contact by GImpact's meshes, distances between compounds of triangles: Bullet has no other for meshes that move.
std::unique_ptr<ContactPeer> make_bullet_peer(const std::vector<const Mesh*>& meshes,
                                              const std::vector<PartPair>& pairs);

}  // namespace foresight
