#include "scene/pose_track.hpp"

#include <algorithm>
#include <stdexcept>

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

}  // namespace foresight
