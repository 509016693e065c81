#include "session/joint_tracks.hpp"

#include <algorithm>

namespace foresight {

void JointTracks::add(const RobotCycle& cycle) {
  for (std::size_t i = 0; i < std::min(tracks_.size(), cycle.joints); ++i)
    if (const JointCycle& joint = cycle.joint[i]; joint.homed && joint.time.ns != 0)
      tracks_[i].add(joint.time, joint.position);
}

JointState JointTracks::at(RobotTime encoder_time) const {
  JointState out{encoder_time, StateStatus::exact, {}};
  for (const ShaftTrack& track : tracks_) {
    const ShaftTrack::Answer answer = track.at(encoder_time);
    out.status = std::max(out.status, answer.status);  // the enumeration goes from best to worst
    out.positions.push_back(answer.shaft);
  }
  return out;
}

bool JointTracks::know(RobotTime encoder_time) const {
  return std::ranges::all_of(tracks_, [&](const ShaftTrack& track) { return track.knows(encoder_time); });
}

}  // namespace foresight
