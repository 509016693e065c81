#include "calibration/registration/head_kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

Eigen::AngleAxisd about_z(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ());
}

double play(double before, double encoder, double backlash) {
  const double half = std::abs(backlash) / 2;
  return std::clamp(before, encoder - half, encoder + half);
}

double behind_play(double encoder, double played, double backlash) {
  return backlash >= 0 ? played : 2 * encoder - played;
}

}  // namespace

Pose T_world_camera(const HeadModel& model, const HeadAngles& shafts) {
  return model.T_world_pan * about_z(shafts.pan) * model.T_pan_tilt * about_z(shafts.tilt) * model.T_tilt_camera;
}

bool ShaftTrack::add(RobotTime encoder_time, double encoder) {
  if (!std::isfinite(encoder)) return false;
  if (samples_.empty())
    played_ = encoder;
  else if (encoder_time <= samples_.back().time)
    return false;
  played_ = play(played_, encoder, axis_.backlash_rad);
  samples_.push_back(
      {encoder_time, axis_.scale * behind_play(encoder, played_, axis_.backlash_rad) + axis_.offset_rad});
  while (to_seconds(encoder_time - samples_.front().time) > options_.kept_s) samples_.pop_front();
  return true;
}

ShaftTrack::Answer ShaftTrack::at(RobotTime time) const {
  const auto after =
      std::lower_bound(samples_.begin(), samples_.end(), time, [](const Sample& s, RobotTime t) { return s.time < t; });
  if (samples_.size() < 2) return {};
  if (after == samples_.begin()) return after->time == time ? Answer{after->shaft, 0, StateStatus::exact} : Answer{};
  const bool ahead = after == samples_.end();
  const Sample& b = ahead ? samples_.back() : *after;
  const Sample& a = *std::prev(ahead ? samples_.end() - 1 : after);
  const double gap = to_seconds(b.time - a.time), since = to_seconds(time - a.time);
  if (gap > options_.largest_gap_s || since > gap + options_.most_ahead_s) return {};
  const double rate = (b.shaft - a.shaft) / gap;
  const StateStatus status =
      ahead ? StateStatus::predicted : (b.time == time ? StateStatus::exact : StateStatus::interpolated);
  return {a.shaft + rate * since, rate, status};
}

bool EncoderTrack::add(RobotTime encoder_time, const HeadAngles& encoders) {
  if (!std::isfinite(encoders.pan) || !std::isfinite(encoders.tilt)) return false;
  const bool pan = add_pan(encoder_time, encoders.pan);
  return add_tilt(encoder_time, encoders.tilt) && pan;
}

EncoderTrack::Answer EncoderTrack::at(RobotTime camera_time) const {
  const RobotTime time = camera_time + seconds(offset_s_);
  const ShaftTrack::Answer pan = pan_.at(time), tilt = tilt_.at(time);
  const StateStatus status = std::max(pan.status, tilt.status);
  if (status == StateStatus::invalid) return {};
  return {{pan.shaft, tilt.shaft}, {pan.rate, tilt.rate}, status};
}

}  // namespace foresight
