// Where the links of a robot are for given joints, and how far they can get when joints move.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/urdf_reader.hpp"

namespace foresight {

/// Thread: one at a time. No method but the constructor and joints_between() allocates or throws.
class PosedLinks {
 public:
  /// `joints`: those whose positions pose() gets, in its order, "" for one that is not of this robot (a pan-tilt
  /// head's); all others stay at 0 or their nearest limit. Mimic joints follow. Throws InputError at `where` for a
  /// joint that the robot does not have.
  PosedLinks(const UrdfRobot& robot, const std::vector<std::string>& joints, const Pose& T_world_root,
             const std::string& where);

  std::size_t size() const noexcept { return T_world_link_.size(); }
  /// How many positions pose() takes.
  std::size_t inputs() const noexcept { return inputs_; }
  void pose(std::span<const double> positions) noexcept;
  const Pose& T_world_link(std::size_t link) const noexcept { return T_world_link_[link]; }
  /// Does it move with any of `joints`?
  bool moves(std::size_t link) const noexcept { return moves_[link]; }

  /// The URDF joints from `link` up to, not including, `ancestor`; -1: all up to the root.
  std::vector<std::size_t> joints_between(std::size_t link, int ancestor) const;
  /// The nearest link that both are or hang on.
  std::size_t common_ancestor(std::size_t one, std::size_t other) const noexcept;
  /// Index into `joints` of what moves this URDF joint; -1: nothing does.
  int input_of(std::size_t joint) const noexcept { return motions_[joint].input; }

  /// Adds to out[k] `weight` times how fast a point that moves with `path`'s joints (joints_between) goes along
  /// `direction` (unit, world) per change of joint k: m per rad or m.
  void add_change(std::span<const std::size_t> path, const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                  double weight, std::span<double> out) const noexcept;
  /// No point of a ball that moves with `path`'s joints goes farther than this, m, while every joint goes evenly by its
  /// `change`: with r_j the distance of its farthest point from axis j now, sum |dq_j| r_j grows by no more than
  /// sum |dq_j| times the way that was made, so that the way is at most sum |dq_j| r_j (e^s - 1) / s, s = sum |dq_j|.
  double farthest(std::span<const std::size_t> path, const Eigen::Vector3d& center, double radius,
                  std::span<const double> change) const noexcept;

 private:
  struct Motion {
    UrdfJoint joint;
    int input = -1;
    double factor = 1, offset = 0;
    std::size_t parent = 0;
  };
  std::vector<Motion> motions_;  // joint j moves link j + 1
  std::vector<Pose> T_world_link_;
  std::vector<bool> moves_;
  std::size_t inputs_ = 0;
};

}  // namespace foresight
