// The last moments of a tracked pose (head, hand, device), as prediction and filtering need them.
//
// Trackers are not ideal: poses are lost, stand still while the tracker has lost them, jump when the tracker finds
// itself again, and are stamped when somebody got round to it. A trail begins anew at each gap and jump, and keeps a
// second time for every sample: `even`, the stamp with its jitter taken out. Poses of most trackers belong to a steady
// clock (the display's, the camera's) although their stamps do not; differences over jittery stamps are noise.
//
//   stamps  |   |    | |     |   |        median step T; the next even time is n T after the last one,
//   even    |   |   |   |   |   |         n = 1, or more where samples were lost, drawn slowly to the stamps
#pragma once

#include <array>

#include "common/time.hpp"
#include "prediction/last_of.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// What became of a pose.
enum class PoseTaken {
  yes,
  anew,     ///< taken, as the first of a new trail: after a gap or a jump, or the first at all
  invalid,  ///< not taken: not finite, or not a rigid pose
  late,     ///< not taken: not after the one before
};

struct PoseTrailOptions {
  double largest_gap = 0.2;  ///< s between samples of one trail, like PoseTrack::kLargestGap
  double fastest = 8;        ///< m/s: a step faster than this and longer than `least_jump` is a jump
  double fastest_turn = 40;  ///< rad/s, likewise
  double least_jump = 0.05;  ///< m; and rad times 4
};

/// One thread. add() and all others neither throw nor allocate.
class PoseTrail {
 public:
  struct Sample {
    OperatorTime time;
    double stamp = 0, even = 0;  ///< s since the first sample at all; `even` without jitter
    Pose pose = Pose::Identity();
  };
  static constexpr std::size_t kMost = 512;

  explicit PoseTrail(const PoseTrailOptions& options = {});

  PoseTaken add(OperatorTime time, const Pose& pose) noexcept;

  /// Of the trail since the last gap or jump, oldest first.
  const LastOf<Sample>& samples() const noexcept { return samples_; }
  /// Seconds of even time that the trail goes back.
  double length() const noexcept;
  /// The pose `lag` >= 0 seconds of even time before the newest; before the trail's begin, as if it had gone on from
  /// there into the past at the speed of its first step. The trail must not be empty.
  Pose back(double lag) const noexcept;

 private:
  bool jumps(const Sample& from, double stamp, const Pose& to) const noexcept;
  double even_time(double stamp) noexcept;

  static constexpr std::size_t kSteps = 31;  ///< the median of so many
  PoseTrailOptions options_;
  LastOf<Sample> samples_{kMost};
  LastOf<double> steps_{kSteps};
  double unevenness_ = 0;  ///< usual distance of stamps from even times, as a share of the step
  bool begun_ = false;
  OperatorTime epoch_;
};

}  // namespace foresight
