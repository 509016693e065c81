#include <algorithm>
#include <cmath>
#include <pugixml.hpp>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"
#include "scene/urdf_limits.hpp"
#include "scene/urdf_reader.hpp"

namespace foresight {
namespace {

void require_settable(const UrdfRobot& robot, const std::string& name, double position, const std::string& where) {
  std::vector<std::string> names;
  for (const UrdfJoint& joint : robot.joints)
    if (joint.kind != UrdfJoint::Kind::fixed && !joint.mimic) names.push_back(joint.name);
  const std::string shown = in_quotes(name);
  const auto joint =
      std::find_if(robot.joints.begin(), robot.joints.end(), [&](const auto& j) { return j.name == name; });
  if (joint == robot.joints.end())
    throw InputError(where, "the robot has no joint " + shown, did_you_mean(name, names, "remove it"));
  if (joint->kind == UrdfJoint::Kind::fixed) throw InputError(where, "joint " + shown + " is fixed", "remove it");
  if (joint->mimic)
    throw InputError(where, "joint " + shown + " follows another",
                     "set '" + robot.joints[static_cast<std::size_t>(joint->mimic->joint)].name + "' instead");
  if (!(position >= joint->lower && position <= joint->upper) || !std::isfinite(position))
    throw InputError(where, "joint " + shown + " at " + std::to_string(position) + " is beyond its limits",
                     "choose from " + std::to_string(joint->lower) + " to " + std::to_string(joint->upper));
}

}  // namespace

void pose_links(UrdfRobot& robot, const std::map<std::string, double>& positions, const std::string& where) {
  for (const auto& [name, position] : positions) require_settable(robot, name, position, where);
  const auto own_position = [&](const UrdfJoint& joint) {
    const auto given = positions.find(joint.name);
    return given != positions.end() ? given->second : std::clamp(0.0, joint.lower, joint.upper);
  };
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const UrdfJoint& joint = robot.joints[j];
    const JointSource source = source_of(robot, j);
    const double position =
        source.factor * own_position(robot.joints[static_cast<std::size_t>(source.joint)]) + source.offset;
    robot.links[static_cast<std::size_t>(joint.child)].T_parent_node =
        joint.T_parent_joint * joint_transform(joint, position);
  }
}

JointSource source_of(const UrdfRobot& robot, std::size_t index) {
  JointSource source{static_cast<int>(index), 1, 0};
  while (const auto& mimic = robot.joints[static_cast<std::size_t>(source.joint)].mimic) {
    source.offset += source.factor * mimic->offset;
    source.factor *= mimic->multiplier;
    source.joint = mimic->joint;
  }
  return source;
}

std::map<std::string, SoftLimits> read_soft_limits(const std::filesystem::path& file) {
  pugi::xml_document document;
  const std::string xml = read_file(file);
  document.load_buffer(xml.data(), xml.size());
  std::map<std::string, SoftLimits> out;
  for (const pugi::xml_node joint : document.child("robot").children("joint")) {
    const pugi::xml_node safety = joint.child("safety_controller");
    // One that is not given counts as 0; so do both, where only gains are given, which is no range.
    const SoftLimits limits{safety.attribute("soft_lower_limit").as_double(),
                            safety.attribute("soft_upper_limit").as_double()};
    if (limits.lower < limits.upper) out[joint.attribute("name").value()] = limits;
  }
  return out;
}

UrdfJoint within_followers(const UrdfRobot& robot, std::size_t index) {
  UrdfJoint out = robot.joints[index];
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const UrdfJoint& follower = robot.joints[i];
    const JointSource source = source_of(robot, i);
    if (!follower.mimic || source.joint != static_cast<int>(index) || source.factor == 0) continue;
    const auto [low, high] = std::minmax(
        {(follower.lower - source.offset) / source.factor, (follower.upper - source.offset) / source.factor});
    if (follower.lower < follower.upper) {  // else it was given none
      out.lower = std::max(out.lower, low);
      out.upper = std::min(out.upper, high);
    }
    if (follower.velocity <= 0) continue;
    const double velocity = follower.velocity / std::abs(source.factor);
    out.velocity = out.velocity > 0 ? std::min(out.velocity, velocity) : velocity;
  }
  return out;
}

Pose joint_transform(const UrdfJoint& joint, double position) noexcept {
  Pose T_joint_child = Pose::Identity();
  if (joint.kind == UrdfJoint::Kind::rotating)
    T_joint_child.linear() = Eigen::AngleAxisd(position, joint.axis).toRotationMatrix();
  if (joint.kind == UrdfJoint::Kind::sliding) T_joint_child.translation() = position * joint.axis;
  return T_joint_child;
}

}  // namespace foresight
