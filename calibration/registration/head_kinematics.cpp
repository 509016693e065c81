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

HeadAngles mix(const HeadAngles& a, const HeadAngles& b, double s) {
  return {a.pan + s * (b.pan - a.pan), a.tilt + s * (b.tilt - a.tilt)};
}

}  // namespace

Pose T_world_camera(const HeadModel& model, const HeadAngles& shafts) {
  return model.T_world_pan * about_z(shafts.pan) * model.T_pan_tilt * about_z(shafts.tilt) * model.T_tilt_camera;
}

bool EncoderTrack::add(RobotTime encoder_time, const HeadAngles& encoders) {
  if (!std::isfinite(encoders.pan) || !std::isfinite(encoders.tilt)) return false;
  if (samples_.empty())
    played_ = encoders;
  else if (encoder_time <= samples_.back().time)
    return false;
  played_ = {play(played_.pan, encoders.pan, model_.pan.backlash_rad),
             play(played_.tilt, encoders.tilt, model_.tilt.backlash_rad)};
  const auto shaft = [](const HeadAxis& axis, double encoder, double played) {
    return axis.scale * behind_play(encoder, played, axis.backlash_rad) + axis.offset_rad;
  };
  samples_.push_back(
      {encoder_time, {shaft(model_.pan, encoders.pan, played_.pan), shaft(model_.tilt, encoders.tilt, played_.tilt)}});
  while (to_seconds(encoder_time - samples_.front().time) > options_.kept_s) samples_.pop_front();
  return true;
}

EncoderTrack::Answer EncoderTrack::at(RobotTime camera_time) const {
  const RobotTime time = camera_time + seconds(model_.offset_s);
  const auto after =
      std::lower_bound(samples_.begin(), samples_.end(), time, [](const Sample& s, RobotTime t) { return s.time < t; });
  if (samples_.size() < 2) return {};
  if (after == samples_.begin()) return after->time == time ? Answer{after->shafts, {}, StateStatus::exact} : Answer{};
  const bool ahead = after == samples_.end();
  const Sample& b = ahead ? samples_.back() : *after;
  const Sample& a = *std::prev(ahead ? samples_.end() - 1 : after);
  const double gap = to_seconds(b.time - a.time), since = to_seconds(time - a.time);
  if (gap > options_.largest_gap_s || since > gap + options_.most_ahead_s) return {};
  const HeadAngles rate{(b.shafts.pan - a.shafts.pan) / gap, (b.shafts.tilt - a.shafts.tilt) / gap};
  const StateStatus status =
      ahead ? StateStatus::predicted : (b.time == time ? StateStatus::exact : StateStatus::interpolated);
  return {mix(a.shafts, b.shafts, since / gap), rate, status};
}

}  // namespace foresight
