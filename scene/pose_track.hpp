// A pose over time, from samples.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

/// A pose over time: `samples` strictly ascending in time.
class PoseTrack {
 public:
  struct Sample {
    RobotTime time;
    Pose pose;
  };
  struct Answer {
    Pose pose = Pose::Identity();
    StateStatus status = StateStatus::invalid;
  };
  static constexpr Duration kExact{1'000'000};         ///< a sample this near is used as it is
  static constexpr Duration kLargestGap{200'000'000};  ///< a larger gap is not interpolated

  PoseTrack() = default;

  /// Throws std::invalid_argument where `samples` do not ascend strictly.
  explicit PoseTrack(std::vector<Sample> samples);

  const std::vector<Sample>& samples() const { return samples_; }

  /// The sample nearest to `time`; the track must not be empty.
  const Sample& nearest(RobotTime time) const;

  /// The nearest sample where it lies within `exact`, else linear (position) and spherical
  /// (rotation) interpolation over a gap of up to kLargestGap, else `invalid`.
  Answer at(RobotTime time, Duration exact = kExact) const;

 private:
  std::vector<Sample> samples_;
};

/// Rows "time tx ty tz qx qy qz qw", as of TUM RGB-D runs. Throws InputError naming file and line: as text_table.hpp,
/// or a row that comes more than `most_apart` after the one before.
PoseTrack read_trajectory(const std::filesystem::path& file, std::optional<Duration> most_apart = {});

/// Position linearly, rotation along the shortest great circle; `s` from 0 (a) to 1 (b).
Pose interpolate(const Pose& a, const Pose& b, double s);

}  // namespace foresight
