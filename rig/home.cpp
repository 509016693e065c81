#include "rig/home.hpp"

#include <algorithm>

namespace foresight {

double home_of(const RigJoint& joint, DriveProtocol protocol) {
  const DriveConfig& d = joint.drive;
  if (protocol == DriveProtocol::cia402 && !joint.absolute) return std::clamp(d.offset, d.min_position, d.max_position);
  const bool has_zero = d.min_position <= 0 && 0 <= d.max_position;
  return has_zero ? 0 : 0.5 * (d.min_position + d.max_position);
}

JointValues home_of(const Rig& rig) {
  JointValues out{};
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    out[i] = home_of(rig.joints[i], rig.buses[rig.joints[i].bus].protocol);
  return out;
}

}  // namespace foresight
