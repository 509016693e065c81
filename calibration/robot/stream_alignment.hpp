// First steps of a time offset: correlation of angular speeds, and hand-eye at a known offset.
#pragma once

#include "calibration/robot/time_offset.hpp"

namespace foresight {

struct Lag {
  double offset_s = 0;
  double correlation = 0;
  std::vector<double> lags_s, correlations;  ///< of the whole search
};

/// Offset with the highest correlation of angular speeds. Throws InputError where the streams
/// overlap for less than 3 s at every offset that is searched, or do not turn.
Lag correlate_speeds(const PoseTrack& encoder, const PoseTrack& camera, const TimeOffsetOptions& options);

struct AlignedPose {
  double time_s = 0;  ///< camera time since the encoder's first sample
  Pose encoder;       ///< at that time plus the offset
  Pose T_camera_target;
};

/// Camera samples whose encoder pose is known for 50 ms around, at most `most` of them, evenly spread.
std::vector<AlignedPose> aligned_poses(const PoseTrack& encoder, const PoseTrack& camera, double offset_s,
                                       bool camera_inverted, std::size_t most);

struct StreamHandEye {
  Pose X = Pose::Identity(), Y = Pose::Identity();
  double misfit = 0;  ///< median, metres and 0.1 m per rad
};

/// Closed form over `poses`; where `rotation_only`, from the turns alone (Wahba's problem).
StreamHandEye stream_hand_eye(const std::vector<AlignedPose>& poses, bool rotation_only);

}  // namespace foresight
