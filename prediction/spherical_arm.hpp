// Inverse kinematics in closed form of seven-joint arms with a spherical shoulder and a spherical wrist.
//
//        S  joints 1 2 3 meet            The distance |SW| alone says where joint 4 stands (two ways). The elbow E can
//       / \                              then turn about SW by the swivel angle psi, from a place to start at:
//      /   \  n = SW / |SW|
//     E     \                              R123(psi) = rot(n, psi) R0        R0 takes W, as joint 4 puts it, to where
//      ` - . W  joints 5 6 7 meet                                            the target wants it
//             \                            R567(psi) = R4' R123(psi)' R_target R_tip(0)'
//              tip
//
// and both are turns of three joints about one point (prediction/swivel.hpp), which can be made in two ways each: eight
// branches, each with intervals of psi. Upper and lower arm may have offsets, and lie anywhere: only joint 4 must
// change the distance |SW|. For arms without such offsets psi is the swivel angle of Shimizu et al. (2008), but for
// where it starts.
#pragma once

#include <optional>

#include "prediction/arm_chain.hpp"
#include "prediction/swivel.hpp"

namespace foresight {

/// Swivel angles, ascending in each interval. No allocation.
class SwivelSamples {
 public:
  static constexpr std::size_t kMost = 128;
  struct Sample {
    double psi = 0;
    bool joined = false;  ///< to the one before, by angles that are within the limits too
  };

  void add(Sample sample) noexcept {
    if (size_ < kMost) samples_[size_++] = sample;
  }
  std::size_t size() const noexcept { return size_; }
  const Sample& operator[](std::size_t i) const noexcept { return samples_[i]; }

 private:
  std::array<Sample, kMost> samples_;
  std::size_t size_ = 0;
};

/// Immutable; any thread. No method allocates or throws.
class SphericalArm {
 public:
  /// Nothing where the chain is no such arm: other than seven turning joints; axes 1 2 3 or 5 6 7 that miss each other
  /// by over 0.9 mm, or whose neighbours are not perpendicular to 9e-4 ("1.57"); a fourth joint that leaves |SW| as it
  /// is. Found from where the axes lie, whatever joints and links are called.
  static std::optional<SphericalArm> recognise(const ArmChain& chain);

  struct Answer {
    JointVector q;      ///< within the limits to 1e-10 and the pose exact, both as far as the axes are spherical
    double margin = 0;  ///< rad to the nearest limit or singularity
  };

  /// The joints for a pose of the tip that are farthest from limits and singularities, over all branches and swivel
  /// angles. Nothing where there are none within the limits.
  std::optional<Answer> solve(const Pose& T_base_tip) const noexcept;

  /// The joints of one of the eight branches, 0 .. 7, with the swivel at `psi`, wherever that starts. Nothing where
  /// they are not within the limits.
  std::optional<Answer> solve_on(const Pose& T_base_tip, std::size_t branch, double psi) const noexcept;
  static constexpr std::size_t kBranches = 8;
  /// Swivel angles of such a branch from end to end of each interval that is within the limits, at most 30 degrees
  /// apart.
  SwivelSamples swivels(const Pose& T_base_tip, std::size_t branch) const noexcept;

  /// The joints nearest to `last` (of seven), then away from limits and singularities by turning the swivel up to
  /// `swivel` rad further on the same branch.
  std::optional<Answer> solve_near(const Pose& T_base_tip, const JointVector& last, double swivel) const noexcept;

  /// The pose with the tip's orientation kept whose wrist is within reach of the shoulder, nearest to T_base_tip.
  Pose pulled_within_reach(const Pose& T_base_tip) const noexcept;

  /// The sine of how far joint 4 is from the angle at which |SW| is longest or shortest, >= 0.
  double elbow_bend(double q4) const noexcept;

 private:
  struct Elbow;
  struct Scored;

  SphericalArm() = default;
  std::optional<Elbow> elbow(const Pose& T_base_tip, double sign) const noexcept;
  double distance_at(double q4) const noexcept;
  JointVector joints(const Elbow& elbow, double psi, BallSide shoulder, BallSide wrist) const noexcept;
  SwivelAngles limit_angles(const Elbow& elbow) const noexcept;
  Scored score(const Elbow& elbow, double psi, double enough) const noexcept;
  Scored score_on(const Elbow& elbow, double psi, BallSide shoulder, BallSide wrist) const noexcept;
  Scored best_swivel(const Elbow& elbow) const noexcept;
  static double nearest_swivel(const Elbow& elbow, const Eigen::Matrix3d& R_last);
  /// q, but each joint at the turn nearest to `last` that its limits allow.
  JointVector turned_towards(const JointVector& last, JointVector q) const noexcept;
  std::array<double, 2> distances_within_limits() const noexcept;  ///< |SW|: shortest, longest

  BallJoint shoulder_, wrist_;
  Eigen::Vector3d S_, W_at_zero_, W_in_tip_;
  Eigen::Vector3d a4_, upper_, lower_;  ///< S to a point of axis 4, from there to W; all at 0
  Eigen::Matrix3d R_tip_at_zero_;
  JointVector lower_limit_, upper_limit_;
  double q4_longest_ = 0;            ///< where |SW| is longest
  double constant_ = 0, swing_ = 0;  ///< |SW|^2 = constant + swing cos(q4 - q4_longest)
  double rounding_ = 0;              ///< rad and m: what counts as on the limit, and is put there
};

}  // namespace foresight
