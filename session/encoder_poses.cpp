#include "session/encoder_poses.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calibration/registration/calibrated_head.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

std::unique_ptr<Registration> make_registration(const RigCalibration& calibration, const StereoLenses& lenses) {
  const HeadModel head = read_head_model(calibration.pan_tilt.value(), calibration.time);
  const TagMap tags = calibration.tags ? read_tag_map(*calibration.tags) : TagMap{};
  RegistrationOptions options = options_for(head);
  if (calibration.photometric) options.detector.inverse_response = read_inverse_response(*calibration.photometric);
  return std::make_unique<Registration>(head, lenses, tags, options);
}

cv::Mat grey(const ColourImage& image) {
  cv::Mat out;
  cv::cvtColor(image.bgr, out, cv::COLOR_BGR2GRAY);
  return out;
}

}  // namespace

// --- EncoderPoses ---------------------------------------------------------------------------------------------------

EncoderPoses::EncoderPoses(const Rig& rig, std::shared_ptr<const LiveScene> scene, Cycles cycles)
    : scene_(std::move(scene)),
      cycles_(std::move(cycles)),
      rig_(rig),
      names_(rig.joint_names()),
      joints_(rig.joints.size()) {
  if (!rig.calibration || !rig.calibration->pan_tilt) return;
  if (!scene_->lenses())
    throw InputError(rig.calibration->pan_tilt->string(), "is of a head whose cameras' lenses are not calibrated",
                     "give them as `lens` in the rig");
  registration_ = make_registration(*rig.calibration, *scene_->lenses());
  std::vector<std::size_t> head;
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    if (rig.joints[i].group == JointGroup::pan_tilt) head.push_back(i);
  pan_ = head.at(0), tilt_ = head.at(1);
}

void EncoderPoses::listen() {
  while (const auto cycle = cycles_.take()) {
    joints_.add(*cycle);
    if (!registration_) continue;
    const JointCycle &pan = cycle->joint[pan_], &tilt = cycle->joint[tilt_];
    if (!pan.homed || !tilt.homed) continue;
    registration_->add_pan(pan.time, pan.position);
    registration_->add_tilt(tilt.time, tilt.position);
  }
}

RobotTime EncoderPoses::on_encoders(RobotTime camera_time) const {
  return registration_ ? camera_time + seconds(registration_->head().offset_s) : camera_time;
}

bool EncoderPoses::is_ready(const StereoPair& pair) {
  listen();
  return joints_.know(on_encoders(std::max(pair.left.time, pair.right.time)));
}

JointPositions EncoderPoses::by_name(const JointState& joints) const {
  return [this, &joints](std::string_view name) -> std::optional<double> {
    const auto at = static_cast<std::size_t>(std::ranges::find(names_, shaft_name(rig_, name)) - names_.begin());
    return at < names_.size() && std::isfinite(joints.positions[at]) ? std::optional(joints.positions[at])
                                                                     : std::nullopt;
  };
}

/// By the lab's drawing, pan and tilt carry them; what a registration needs, it sees to itself.
bool EncoderPoses::cameras_known(const JointState& joints) const {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (!registration_ && !joints.known[i] &&
        (names_[i] == shaft_name(rig_, "pan") || names_[i] == shaft_name(rig_, "tilt")))
      return false;
  return std::ranges::find(joints.known, true) != joints.known.end();
}

SceneState EncoderPoses::scene_at(RobotTime time, const JointState& joints) const {
  const StateStatus status = joints.status == StateStatus::invalid ? StateStatus::predicted : joints.status;
  return scene_->state_at(time, by_name(joints), status);
}

PairPoses EncoderPoses::poses_of(const StereoPair& pair) {
  listen();
  PairPoses out;
  out.joints = joints_.at(on_encoders(pair.left.time));
  const JointState right = joints_.at(on_encoders(pair.right.time));
  if (registration_)
    register_cameras(pair, out);
  else if (scene_->is_mock())
    out.quality = "encoders";
  if (!cameras_known(out.joints) || !cameras_known(right)) {
    out.T_world_camera.reset();
    if (out.quality != "none") out.quality = "lost";
    return out;
  }
  if (out.quality == "encoders" && !registration_)
    out.T_world_camera = {scene_->T_world_left(by_name(out.joints)),
                          scene_->T_world_left(by_name(right)) * scene_->lenses()->T_left_right};
  out.scene = {scene_at(pair.left.time, out.joints), scene_at(pair.right.time, right)};
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (!out.joints.known[i] || !right.known[i]) out.missing += (out.missing.empty() ? "" : ", ") + names_[i];
  return out;
}

void EncoderPoses::register_cameras(const StereoPair& pair, PairPoses& out) {
  const RegistrationResult found = registration_->register_pair(pair.left.time, grey(pair.left), grey(pair.right));
  out.quality = to_string(found.quality);
  out.predicted_px = found.predicted_px;
  if (found.quality == RegistrationQuality::lost) return;
  const auto T_world_left = registration_->moved(pair.left.time, found.T_world_left, pair.right.time);
  if (!T_world_left) {
    out.quality = to_string(RegistrationQuality::lost);
    return;
  }
  out.T_world_camera = {found.T_world_left, *T_world_left * scene_->lenses()->T_left_right};
}

// --- GivenPoses -----------------------------------------------------------------------------------------------------

PairPoses GivenPoses::poses_of(const StereoPair& pair) {
  PairPoses out;
  if (!T_world_left_) return out;
  const auto state = [&](RobotTime time) {
    const auto at = [&](std::string_view joint) { return joints_ ? joints_(joint, time) : std::nullopt; };
    return scene_->state_at(time, at, StateStatus::exact);
  };
  const Pose T_left_right = scene_->lenses() ? scene_->lenses()->T_left_right : Pose::Identity();
  out.T_world_camera = {T_world_left_(pair.left.time), T_world_left_(pair.right.time) * T_left_right};
  out.scene = {state(pair.left.time), state(pair.right.time)};
  out.quality = "given";
  return out;
}

}  // namespace foresight
