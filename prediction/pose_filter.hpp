// Hand poses without their noise, and not a moment later: what a low-pass filter takes as delay costs more than the
// noise.
//
//   filtered = newest + sum_k a_k (v_k - v_k+1) / 60 s        v_k: velocities between the lags, newest first
//
// Differences of velocities are 0 in even motion, whatever the weights: the filter has no lag there, by construction.
// The weights are learnt online, of each pose as soon as 60 ms of its future are known, towards the parabola through
// the 60 ms to both of its sides, which needs no past to lean on: a tracker with much noise is smoothed much, a quiet
// one hardly. Position and rotation each have weights of their own.
#pragma once

#include <optional>

#include "prediction/arm_chain.hpp"
#include "prediction/online_regression.hpp"
#include "prediction/pose_trail.hpp"

namespace foresight {

inline constexpr double kFilterSide = 0.06;  ///< s to both sides that say what a pose was without noise

/// From `samples[i]` to the parabola, in even time, through what lies within kFilterSide of it: position (m), rotation
/// vector (rad). Nothing where fewer than two samples lie on a side.
std::optional<Vector6> offset_to_smooth(const LastOf<PoseTrail::Sample>& samples, std::size_t i) noexcept;

struct PoseFilterOptions {
  double memory = 60;  ///< s of the past that weights are learnt from
  PoseTrailOptions trail;
};

/// One thread. observe() neither throws nor allocates.
class PoseFilter {
 public:
  explicit PoseFilter(const PoseFilterOptions& options = {});

  /// The tracker's newest pose, captured at `time`.
  PoseTaken observe(OperatorTime time, const Pose& pose) noexcept;
  /// Where the hand was at the newest pose that was taken; the first of a trail is as it was seen.
  const Pose& pose() const noexcept { return filtered_; }

 private:
  using Inputs = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostWeights>;
  struct Pending {  // a sample whose future is not known yet
    double even = 0;
    Inputs inputs;
  };

  Inputs inputs() const noexcept;
  void learn() noexcept;

  PoseTrail trail_;
  OnlineRegression position_, rotation_;
  LastOf<Pending> pending_{PoseTrail::kMost};
  Pose filtered_ = Pose::Identity();
};

}  // namespace foresight
