// KDL's inverse kinematics on the same arm, as a peer to compare with. The only place that knows KDL.
#pragma once

#include <functional>
#include <optional>

#include "prediction/arm_chain.hpp"

namespace foresight {

struct KdlPeer {
  std::function<JointVector(const Pose&)> nr_jl;  ///< start in the middle of the limits, 1e-5, 500 iterations
  std::function<JointVector(const Pose&)> lma;    ///< weights 1, 1e-8, start 0
};

/// Nothing where this was built without KDL, and for an arm with joints that follow others. `chain` need not outlive
/// the peer.
std::optional<KdlPeer> make_kdl_peer(const ArmChain& chain);

}  // namespace foresight
