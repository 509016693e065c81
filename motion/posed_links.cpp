#include "motion/posed_links.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {

PosedLinks::PosedLinks(const UrdfRobot& robot, const std::vector<std::string>& joints, const Pose& T_world_root,
                       const std::string& where)
    : T_world_link_(robot.links.size(), T_world_root), moves_(robot.links.size(), false), inputs_(joints.size()) {
  std::vector<std::string> names;
  for (const UrdfJoint& joint : robot.joints) names.push_back(joint.name);
  for (const std::string& joint : joints)
    if (!joint.empty() && std::find(names.begin(), names.end(), joint) == names.end())
      throw InputError(where, "the URDF has no joint " + in_quotes(joint), did_you_mean(joint, names));
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const JointSource source = source_of(robot, j);
    const UrdfJoint& leads = robot.joints[static_cast<std::size_t>(source.joint)];
    const auto given = std::find(joints.begin(), joints.end(), leads.name);
    const bool stays = given == joints.end();
    const double rest = stays ? source.factor * std::clamp(0.0, leads.lower, leads.upper) : 0;
    const auto parent = static_cast<std::size_t>(robot.links[j + 1].parent);
    const int input = stays ? -1 : static_cast<int>(given - joints.begin());
    motions_.push_back({robot.joints[j], input, source.factor, rest + source.offset, parent});
    moves_[j + 1] = input >= 0 || moves_[parent];
  }
}

void PosedLinks::pose(std::span<const double> positions) noexcept {
  for (std::size_t j = 0; j < motions_.size(); ++j) {
    const Motion& m = motions_[j];
    const double q = m.offset + (m.input < 0 ? 0 : m.factor * positions[static_cast<std::size_t>(m.input)]);
    T_world_link_[j + 1] = T_world_link_[m.parent] * m.joint.T_parent_joint * joint_transform(m.joint, q);
  }
}

std::vector<std::size_t> PosedLinks::joints_between(std::size_t link, int ancestor) const {
  std::vector<std::size_t> out;
  for (std::size_t at = link; at != 0 && static_cast<int>(at) != ancestor; at = motions_[at - 1].parent)
    out.push_back(at - 1);
  return out;
}

std::size_t PosedLinks::common_ancestor(std::size_t one, std::size_t other) const noexcept {
  while (one != other) {
    std::size_t& later = one > other ? one : other;  // parents come first: it is no ancestor of the other
    later = motions_[later - 1].parent;
  }
  return one;
}

void PosedLinks::add_change(std::span<const std::size_t> path, const Eigen::Vector3d& point,
                            const Eigen::Vector3d& direction, double weight, std::span<double> out) const noexcept {
  for (const std::size_t j : path) {
    const Motion& m = motions_[j];
    if (m.input < 0 || m.joint.kind == UrdfJoint::Kind::fixed) continue;
    const Pose& T = T_world_link_[j + 1];
    const Eigen::Vector3d axis = T.linear() * m.joint.axis;  // turning about it, or sliding along, leaves it as it is
    const double change = m.joint.kind == UrdfJoint::Kind::sliding ? direction.dot(axis)
                                                                   : direction.dot(axis.cross(point - T.translation()));
    out[static_cast<std::size_t>(m.input)] += weight * m.factor * change;
  }
}

double PosedLinks::farthest(std::span<const std::size_t> path, const Eigen::Vector3d& center, double radius,
                            std::span<const double> change) const noexcept {
  double way = 0, turned = 0;
  for (const std::size_t j : path) {
    const Motion& m = motions_[j];
    if (m.input < 0 || m.joint.kind == UrdfJoint::Kind::fixed) continue;
    const double dq = std::abs(m.factor * change[static_cast<std::size_t>(m.input)]);
    if (m.joint.kind == UrdfJoint::Kind::sliding) {
      way += dq;
      continue;
    }
    const Pose& T = T_world_link_[j + 1];
    way += dq * ((T.linear() * m.joint.axis).cross(center - T.translation()).norm() + radius);
    turned += dq;
  }
  return turned > 1e-9 ? way * std::expm1(turned) / turned : way;
}

}  // namespace foresight
