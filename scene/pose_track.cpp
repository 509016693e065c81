#include "scene/pose_track.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"

namespace foresight {

Pose interpolate(const Pose& a, const Pose& b, double s) {
  Pose out = Pose::Identity();
  out.translation() = a.translation() + s * (b.translation() - a.translation());
  // Eigen's slerp takes the shorter of the two ways round.
  out.linear() =
      Eigen::Quaterniond(a.linear()).slerp(s, Eigen::Quaterniond(b.linear())).normalized().toRotationMatrix();
  return out;
}

PoseTrack::PoseTrack(std::vector<Sample> samples) : samples_(std::move(samples)) {
  for (std::size_t i = 1; i < samples_.size(); ++i)
    if (samples_[i].time <= samples_[i - 1].time) throw std::invalid_argument("the samples of a track must ascend");
}

const PoseTrack::Sample& PoseTrack::nearest(RobotTime time) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), time,
                                      [](const Sample& sample, RobotTime t) { return sample.time < t; });
  if (after == samples_.begin()) return *after;
  const auto before = std::prev(after);
  if (after == samples_.end()) return *before;
  return time - before->time <= after->time - time ? *before : *after;
}

PoseTrack::Answer PoseTrack::at(RobotTime time, Duration exact) const {
  if (samples_.empty()) return {};
  const Sample& near = nearest(time);
  if (std::chrono::abs(near.time - time) <= exact) return {near.pose, StateStatus::exact};
  const std::size_t i = static_cast<std::size_t>(&near - samples_.data());
  const std::size_t other = near.time < time ? i + 1 : i - 1;  // wraps below 0, out of range too
  if (other >= samples_.size()) return {};
  const Sample& a = samples_[std::min(i, other)];
  const Sample& b = samples_[std::max(i, other)];
  const Duration gap = b.time - a.time;
  if (gap > kLargestGap) return {};
  const double s = to_seconds(time - a.time) / to_seconds(gap);
  return {interpolate(a.pose, b.pose, s), StateStatus::interpolated};
}

PoseTrack read_trajectory(const std::filesystem::path& file, std::optional<Duration> most_apart) {
  std::vector<PoseTrack::Sample> samples;
  for_each_row(file, "time tx ty tz qx qy qz qw", [&](const TextRow& row) {
    const PoseTrack::Sample sample{time_field(row, 0), pose_fields(row, 1)};
    if (!samples.empty()) {
      require_ascending(row, samples.back().time, sample.time);
      const Duration after = sample.time - samples.back().time;
      if (most_apart && after > *most_apart)
        throw InputError(row.where(), "comes " + readable(to_seconds(after), 3, " s") + " after the row before",
                         "give poses no more than " + readable(to_seconds(*most_apart), 1, " s") + " apart");
    }
    samples.push_back(sample);
  });
  return PoseTrack(std::move(samples));
}

}  // namespace foresight
