// A hand that goes from stop to stop, as a script tells: the joints at every instant, made beforehand.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "prediction/inverse_kinematics.hpp"

namespace foresight {

/// From 0 to 1 with the least jerk, for `share` of the time from 0 to 1 (Flash and Hogan 1985).
double minimum_jerk(double share);

struct HandStop {
  std::string name;  ///< for messages
  Pose T_base_tip = Pose::Identity();
  double grip = 0;         ///< position of the gripper's joint, rad or m
  double seconds = 1;      ///< from the stop before; > 0. At rest here and there, smooth in between
  bool by_joints = false;  ///< goes evenly in the joints, to where they have the most room; else straight
};

/// Immutable; any thread.
class HandPath {
 public:
  static constexpr double kStep = 0.004;  ///< s between the joints that are kept

  /// From `start` and `grip` to one stop after the other. `kinematics` is not kept. Throws InputError naming the stop:
  /// out of reach, or not to be reached in that time on that way; a time that is not positive.
  HandPath(const InverseKinematics& kinematics, const JointVector& start, double grip, std::span<const HandStop> stops);

  double seconds() const { return static_cast<double>(joints_.size() - 1) * kStep; }
  /// When stop `i` is reached, s.
  double reached(std::size_t i) const { return reached_.at(i); }
  /// Before the start and after the end: as there.
  JointVector joints(double seconds) const;
  double grip(double seconds) const;

 private:
  struct Place {
    std::size_t before = 0;
    double share = 0;
  };
  Place place(double seconds) const;
  void go_straight(const InverseKinematics& kinematics, const HandStop& stop, int steps);
  void go_by_joints(const InverseKinematics& kinematics, const HandStop& stop, int steps);

  std::vector<JointVector> joints_;
  std::vector<double> grips_;
  std::vector<double> reached_;
};

}  // namespace foresight
