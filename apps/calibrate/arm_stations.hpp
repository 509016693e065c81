// Where a robot goes to show a board to a camera, or a camera to a board, so that a hand-eye can be solved.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "calibration/robot/joint_chain.hpp"
#include "rig/rig.hpp"

namespace foresight {

/// Proposes stations around the first one, at which the board was seen: turns of the flange that are far from those
/// which were taken, within the joints' limits, and clear of all surroundings there and on the straight way from the
/// last station (the safety gate looks again while the robot moves). How far it goes follows what was seen. One thread.
class ArmStations {
 public:
  /// `chain`: from the rig's robot, its joints among the rig's. `start`: where all joints of the rig stand.
  ArmStations(const Rig& rig, JointChain& chain, const JointValues& start, unsigned seed);

  /// The first station, where it is not where the robot stands.
  void start_at(const JointValues& start) { start_ = start; }

  /// Positions of all joints of the rig; those outside of the chain stay. Nothing where no station is left that is
  /// clear.
  std::optional<JointValues> next();
  /// What the station from next() was worth; `reached`: the robot stood there, `seen`: and the board was in view.
  void judge(bool reached, bool seen);

  /// Positions of the chain's joints, as `positions` has them.
  std::vector<double> of_chain(const JointValues& positions) const;
  const std::vector<std::size_t>& joints() const { return rig_joints_; }

 private:
  bool clear(const JointValues& positions) noexcept;
  bool clear_way(const JointValues& to) noexcept;
  JointValues propose();
  double novelty(const JointValues& positions);

  const Rig& rig_;
  JointChain& chain_;
  std::unique_ptr<RobotShape> shape_;    // may be null
  std::vector<std::size_t> rig_joints_;  // of the chain's joints, in its order
  std::vector<GateJoint> limits_;        // of the rig's joints
  std::vector<double> margins_;
  std::mt19937 random_;
  JointValues start_{}, last_{}, proposed_{};
  std::vector<Pose> taken_;  // flanges
  double reach_ = 1;         // share of the largest turns
  bool started_ = false;
};

}  // namespace foresight
