// Where a head (or a hand) will be when the picture drawn for it is seen: some 100 ms ahead of its newest pose.
//
//   lags     12      8    6   4  3  2  1  0   / 60 s of even time
//   trail  ---x------x----x---x--x--x--x--x . . . . . . ?
//             | v_7  |    |   |  | v_0 |  |             ahead
//
// Position: the displacement over `ahead` is a sum of the velocities between the lags, each times `ahead` and a weight,
// and of what the newest turning of the head does to a point fixed in it (the tracked point is not the one that the
// neck turns about). Rotation: the rotation vector over `ahead`, likewise of those between the lags. The weights are
// learnt online (OnlineRegression), of each pose as soon as its future has been seen, and from nothing else; until
// then, and where nothing speaks against it, the head goes on at its mean velocity of the last 50 ms, the newest
// counting most.
//
// Learning per person and tracker replaces what a Kalman filter would have to be told: noise of the tracker, its own
// filters and latency, and how people accelerate. Linear prediction of head motion from the past: van Rhijn et al.
// 2005, Laviola 2003; that low-order predictors suffice up to 100 ms: Azuma and Bishop 1995.
#pragma once

#include "prediction/calibrated_sigma.hpp"
#include "prediction/online_regression.hpp"
#include "prediction/pose_trail.hpp"

namespace foresight {

struct PosePredictorOptions {
  double ahead = 0.1;  ///< s: the usual time from the newest pose to the wanted instant, for which weights are learnt
  double farthest = 0.5;  ///< s: farther ahead of the newest pose nothing is said
  double memory = 60;     ///< s of the past that weights are learnt from
  PoseTrailOptions trail;
};

struct PosePrediction {
  StateStatus status = StateStatus::invalid;  ///< predicted; exact at the newest pose's own instant; else invalid
  Pose pose = Pose::Identity();
  /// m and rad: the truth lies within twice of that of `pose`, in 95 % of cases.
  double position_sigma = 0, rotation_sigma = 0;
};

/// One thread. Neither observe() nor at() throws or allocates.
class PosePredictor {
 public:
  explicit PosePredictor(const PosePredictorOptions& options = {});

  /// The tracker's newest pose, captured at `time`.
  PoseTaken observe(OperatorTime time, const Pose& pose) noexcept;
  /// The pose at `time`, of all that was observed so far. Invalid before the first pose, before the newest one (the
  /// past is the trail's), and farther than `farthest` ahead of it.
  PosePrediction at(OperatorTime time) const noexcept;

  const PoseTrail& trail() const noexcept { return trail_; }

 private:
  using Inputs = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostWeights>;
  struct Pending {  // a pose whose future has not been seen yet
    double stamp = 0;
    Pose pose = Pose::Identity();
    Inputs position, rotation;
    Eigen::Vector3d way{0, 0, 0}, turn{0, 0, 0};  // that were predicted
    double position_sigma = 0, rotation_sigma = 0;
    bool complete = false;  // its inputs reach back as far as the lags do
  };

  void learn() noexcept;
  void predict() noexcept;
  double start_sigma(double usual) const noexcept;

  PosePredictorOptions options_;
  PoseTrail trail_;
  OnlineRegression position_, rotation_;
  CalibratedSigma position_sigma_, rotation_sigma_;
  LastOf<Pending> pending_{PoseTrail::kMost};
  double learnt_until_ = 0;
};

}  // namespace foresight
