// An operator who moves a robot about: smoothly up to full speed, and at times by asking for a far place at once.
#pragma once

#include <memory>
#include <random>

#include "rig/rig.hpp"

namespace foresight {

/// The same seed gives the same motion. One thread.
class RandomMotion {
 public:
  /// `start`: where the robot stands at time 0.
  RandomMotion(const Rig& rig, const JointValues& start, unsigned seed);
  /// What is asked for `seconds` after the start, which never goes back.
  JointValues at(double seconds);

 private:
  struct Leg {
    double begin = 0, lasts = 0;
    bool at_once = false;
    JointValues from{}, to{};
  };
  void next_leg();
  JointValues any_goal(double share);
  bool is_clear(const JointValues& from, const JointValues& to);
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  const Rig& rig_;
  std::unique_ptr<RobotShape> shape_;
  std::mt19937_64 random_;
  Leg leg_;
};

}  // namespace foresight
