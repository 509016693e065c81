#include "session/joint_tracks.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace foresight {
namespace {

constexpr Duration kSilent = std::chrono::milliseconds(300);  // so much older than the others' word

}  // namespace

std::string unknown_joints(const std::vector<bool>& known, char key) {
  const auto unknown = std::ranges::count(known, false);
  if (unknown == 0) return "";
  return fmt::format("{} of {} joints tell no position; home them ({})", unknown, known.size(), key);
}

void JointTracks::add(const RobotCycle& cycle) {
  for (std::size_t i = 0; i < std::min(tracks_.size(), cycle.joints); ++i)
    if (const JointCycle& joint = cycle.joint[i]; joint.homed && joint.time.ns != 0) {
      tracks_[i].add(joint.time, joint.position);
      told_[i] = {joint.time, joint.position};
    }
}

JointState JointTracks::at(RobotTime encoder_time) const {
  JointState out{encoder_time, StateStatus::exact, {}, {}};
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const ShaftTrack::Answer answer = tracks_[i].at(encoder_time);
    const bool known = answer.status != StateStatus::invalid;
    out.status = std::max(out.status, answer.status);  // the enumeration goes from best to worst
    out.positions.push_back(known ? answer.shaft : told_[i].position);
    out.known.push_back(known);
  }
  return out;
}

RobotTime JointTracks::newest() const {
  RobotTime newest, common{INT64_MAX};
  for (const Told& told : told_) newest = std::max(newest, told.time);
  for (const Told& told : told_)
    if (newest - told.time < kSilent) common = std::min(common, told.time);
  return newest.ns == 0 ? newest : common;
}

bool JointTracks::know(RobotTime encoder_time) const {
  RobotTime newest;
  for (const Told& told : told_) newest = std::max(newest, told.time);
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    if (newest - told_[i].time < kSilent && !tracks_[i].knows(encoder_time)) return false;
  return newest.ns != 0;
}

}  // namespace foresight
