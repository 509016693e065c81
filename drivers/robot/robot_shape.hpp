// Where the links of a robot are, as capsules, and whether they touch what they must not touch.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
/// a step is taken off. Negative where they overlap.
double distance(const Capsule& capsule, const Eigen::AlignedBox3d& box);

/// Where the links may be. World frame, metres.
struct Surroundings {
  Eigen::AlignedBox3d workspace;               ///< no link that moves leaves it; empty: anywhere
  std::vector<Eigen::AlignedBox3d> obstacles;  ///< tables, walls, the stand
  double clearance = 0.02;                     ///< kept from obstacles and between links; > 0
};

/// A robot's links as capsules around their meshes. Thread: one at a time.
class RobotShape {
 public:
  /// `joints`: those whose positions obstructed() gets, in its order, "" for one that is not of this robot (a pan-tilt
  /// head's); all others stay at 0 or their nearest limit. Mimic joints follow. Throws InputError at `where` for a
  /// joint that the robot does not have.
  RobotShape(UrdfRobot robot, std::vector<std::string> joints, const Pose& T_world_root, const std::string& where);

  /// What keeps the robot from standing there, such as "link 'arm_5' leaves the workspace"; nullptr where nothing does.
  /// Does not allocate. Links that are one or two joints apart are not compared: their neighbours' covers overlap.
  const char* obstructed(std::span<const double> positions, const Surroundings& surroundings) noexcept;

 private:
  struct Link {
    Capsule body;  ///< in the link's frame
    bool has_body = false, moves = false;
    std::string leaves, hits_obstacle;  ///< messages
  };
  struct Pair {
    std::size_t one, other;
    std::string message;
  };
  void pose(std::span<const double> positions) noexcept;

  UrdfRobot robot_;
  std::vector<int> input_;  ///< per URDF joint, the index of its position, or -1
  std::vector<double> factor_, offset_;
  std::vector<Pose> T_world_link_;
  std::vector<Link> links_;
  std::vector<Capsule> placed_;
  std::vector<Pair> pairs_;
};

}  // namespace foresight
