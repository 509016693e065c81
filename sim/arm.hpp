// The lab's arm: seven joints like a human arm's, and two fingers.
//
//   joint 1..3  shoulder  z y z       stand --1-- arm_1 --2-- arm_2 --3-- arm_3 --4-- arm_4 --5-- arm_5
//   joint 4     elbow     y           --6-- arm_6 --7-- arm_7 --- finger_left, finger_right
//   joint 5..7  wrist     z y z
//   fingers     sliding   y, the right one mimics the left
//
// At zero all z axes point up and the arm is stretched. Shoulder to elbow 0.36 m, elbow to wrist
// 0.34 m, wrist to fingertips 0.20 m.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "scene/scene_model.hpp"
#include "scene/urdf_reader.hpp"

namespace foresight::sim {

struct ArmJoint {
  const char *name, *child;
  int parent;            ///< index into the links
  bool slides;           ///< else it turns
  Eigen::Vector3d xyz;   ///< joint frame in the parent link's frame, metres; parallel to it
  Eigen::Vector3d axis;  ///< in the joint frame
  double lower, upper;   ///< rad or m
  bool mimics = false;   ///< takes the position of the joint before it
};

inline constexpr int kArmLinks = 10;  ///< stand, arm_1 .. arm_7, two fingers
inline constexpr const char* kArmStand = "stand";

/// Joint i moves link i + 1.
const std::array<ArmJoint, kArmLinks - 1>& arm_joints();

/// Joint positions.
struct ArmPosition {
  std::array<double, 7> joints{};  ///< rad
  double opening = 0;              ///< way of each finger from closed, metres
};

Pose T_world_stand();

/// T_world_link of the stand and all links.
std::array<Pose, kArmLinks> arm_links_at(const ArmPosition& position);

inline constexpr double kTips = 0.15;  ///< m: the finger tips, along z of the last link

/// T_world_link of the last link when it points down with the tips at `p_world` and the fingers closing along `yaw`.
Pose pointing_down(const Eigen::Vector3d& p_world, double yaw);

/// Is this the lab's own arm, standing in its place? By joints, links and frames (1 mm); shapes do not count.
bool is_lab_arm(const UrdfRobot& robot, const Pose& T_world_root);

/// The robot as URDF; link meshes are meshes/LINK.ply.
std::string arm_urdf();

}  // namespace foresight::sim
