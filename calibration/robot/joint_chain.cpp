#include "calibration/robot/joint_chain.hpp"

#include <algorithm>
#include <map>

#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

int find_link(const UrdfRobot& robot, const std::string& name, const std::filesystem::path& urdf) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].name == name) return static_cast<int>(i);
    names.push_back(robot.links[i].name);
  }
  throw InputError(urdf.string(), "has no link " + in_quotes(name), did_you_mean(name, names));
}

// Moving joints from `base` to `link`; nothing where `base` is not above it.
std::optional<std::vector<int>> joints_between(const UrdfRobot& robot, int base, int link) {
  std::vector<int> joints;
  for (; link != base; link = robot.links[static_cast<std::size_t>(link)].parent) {
    if (link <= 0) return std::nullopt;
    const UrdfJoint& joint = robot.joints[static_cast<std::size_t>(link - 1)];
    if (joint.kind != UrdfJoint::Kind::fixed && !joint.mimic) joints.insert(joints.begin(), link - 1);
  }
  return joints;
}

// Fingers slide: they do not count.
int turning_joints(const UrdfRobot& robot, int base, int link) {
  const auto joints = joints_between(robot, base, link);
  if (!joints) return 0;
  return static_cast<int>(std::count_if(joints->begin(), joints->end(), [&](int joint) {
    return robot.joints[static_cast<std::size_t>(joint)].kind == UrdfJoint::Kind::rotating;
  }));
}

}  // namespace

JointChain read_joint_chain(const std::filesystem::path& urdf, const std::string& base, const std::string& flange) {
  return joint_chain_of(read_urdf(urdf, urdf.parent_path(), UrdfShapes::none), base, flange, urdf);
}

JointChain joint_chain_of(UrdfRobot robot, const std::string& base, const std::string& flange,
                          const std::filesystem::path& urdf) {
  JointChain chain;
  chain.robot = std::move(robot);
  if (!base.empty()) chain.base = find_link(chain.robot, base, urdf);
  if (!flange.empty()) {
    chain.flange = find_link(chain.robot, flange, urdf);
  } else {
    int most = 0;
    for (std::size_t i = 0; i < chain.robot.links.size(); ++i) {
      const int turning = turning_joints(chain.robot, chain.base, static_cast<int>(i));
      if (turning > most) most = turning, chain.flange = static_cast<int>(i);
    }
  }
  const auto joints = joints_between(chain.robot, chain.base, chain.flange);
  if (!joints || joints->empty())
    throw InputError(urdf.string(), "no moving joint lies between its links for base and flange",
                     "name them by --base-link and --flange-link");
  chain.joints = *joints;
  return chain;
}

Pose flange_pose(JointChain& chain, const std::vector<double>& positions, const std::string& where) {
  if (positions.size() != chain.joints.size())
    throw InputError(where, "has " + counted(positions.size(), "joint position"),
                     "write " + std::to_string(chain.joints.size()) + ", in the order of the chain");
  std::map<std::string, double> named;
  for (std::size_t i = 0; i < positions.size(); ++i)
    named[chain.robot.joints[static_cast<std::size_t>(chain.joints[i])].name] = positions[i];
  pose_links(chain.robot, named, where);
  Pose T = Pose::Identity();
  for (int link = chain.flange; link != chain.base; link = chain.robot.links[static_cast<std::size_t>(link)].parent)
    T = chain.robot.links[static_cast<std::size_t>(link)].T_parent_node * T;
  return T;
}

RobotPose jointed_pose(JointChain& chain, const std::vector<double>& positions, const std::vector<double>& offsets,
                       const std::string& where) {
  constexpr double kStep = 1e-5;
  std::vector<double> at = positions;
  flange_pose(chain, at, where);  // the limits are the reported positions' own
  for (UrdfJoint& joint : chain.robot.joints) joint.lower -= 0.2, joint.upper += 0.2;
  for (std::size_t i = 0; i < at.size(); ++i) at[i] += offsets[i];
  RobotPose robot{flange_pose(chain, at, where), {}};
  if (at.size() > 2) robot.flange_per_joint.resize(6, static_cast<Eigen::Index>(at.size()) - 2);
  for (std::size_t i = 1; i + 1 < at.size(); ++i) {
    std::vector<double> up = at, down = at;
    up[i] += kStep, down[i] -= kStep;
    robot.flange_per_joint.col(static_cast<Eigen::Index>(i) - 1) =
        (step_between(robot.T_base_flange, flange_pose(chain, up, where)) -
         step_between(robot.T_base_flange, flange_pose(chain, down, where))) /
        (2 * kStep);
  }
  for (UrdfJoint& joint : chain.robot.joints) joint.lower += 0.2, joint.upper -= 0.2;
  return robot;
}

HandEyeSummary solve_with_joints(JointChain& chain, const std::vector<std::vector<double>>& rows, HandEyeData data,
                                 const HandEyeOptions& options) {
  std::vector<double> offsets(chain.joints.size(), 0.0);
  HandEyeOptions quick = options;
  quick.score = false;
  for (int round = 0;; ++round) {
    data.poses.clear();
    data.joint_offsets.clear();
    if (offsets.size() > 2) data.joint_offsets.assign(offsets.begin() + 1, offsets.end() - 1);
    for (std::size_t v = 0; v < rows.size(); ++v)
      data.poses.push_back(jointed_pose(chain, rows[v], offsets, "joints of view " + data.corners.views[v].name));
    const bool last = round == 4;
    HandEyeSummary summary = solve_hand_eye(data, last ? options : quick);
    double change = 0;
    for (std::size_t i = 0; i < summary.joint_offsets.size(); ++i) {
      change = std::max(change, std::abs(summary.joint_offsets[i]));
      offsets[i + 1] += summary.joint_offsets[i];
    }
    if (!last && change > 1e-7) continue;
    if (!last && options.score) {
      round = 3;
      continue;
    }
    summary.joint_offsets = offsets;
    std::vector<double> sigma(offsets.size(), 0.0);
    std::copy(summary.joint_offset_sigma.begin(), summary.joint_offset_sigma.end(), sigma.begin() + (sigma.size() > 1));
    summary.joint_offset_sigma = sigma;
    return summary;
  }
}

}  // namespace foresight
