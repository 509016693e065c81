// The lab's own arm as a hand that works on the table: where its joints have to be, by inverse kinematics.
#pragma once

#include <numbers>

#include "prediction/grasp/hand_path.hpp"
#include "scene/urdf_reader.hpp"
#include "sim/arm.hpp"
#include "sim/live_lab.hpp"
#include "tests/support/folders.hpp"

namespace foresight::sim {

inline const InverseKinematics& lab_kinematics() {
  static const InverseKinematics kinematics(read_arm_chain(source_folder() / "configs/arm.urdf", "arm_7"));
  return kinematics;
}

/// The last link, in the arm's base, with the tips at `p_world` and the fingers closing along `yaw`.
inline Pose reaching_down(const Eigen::Vector3d& p_world, double yaw) {
  return T_world_stand().inverse() * pointing_down(p_world, yaw);
}

inline JointVector bent_arm() {
  JointVector q(7);
  for (int i = 0; i < 7; ++i) q[i] = *shafts_at_rest(arm_joints()[static_cast<std::size_t>(i)].name);
  return q;
}

inline ShaftsAt shafts_on(std::shared_ptr<const HandPath> path, RobotTime start) {
  return [path, start](std::string_view joint, RobotTime time) -> std::optional<double> {
    const double t = to_seconds(time - start);
    for (int i = 0; i < 7; ++i)
      if (joint == arm_joints()[static_cast<std::size_t>(i)].name) return path->joints(t)[i];
    return joint == "finger" ? std::optional(path->grip(t)) : std::nullopt;
  };
}

}  // namespace foresight::sim
