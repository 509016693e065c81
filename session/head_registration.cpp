#include "session/head_registration.hpp"

#include <opencv2/imgproc.hpp>

#include "calibration/registration/calibrated_head.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostRows = 6000;  // a minute; more are of a time when nothing was recorded

Registration make_registration(const RigCalibration& calibration, const StereoLenses& lenses) {
  const HeadModel head = read_head_model(calibration.pan_tilt.value(), calibration.time);
  const TagMap tags = calibration.tags ? read_tag_map(*calibration.tags) : TagMap{};
  RegistrationOptions options = options_for(head);
  if (calibration.photometric) options.detector.inverse_response = read_inverse_response(*calibration.photometric);
  return {head, lenses, tags, options};
}

cv::Mat grey(const ColourImage& image) {
  cv::Mat out;
  cv::cvtColor(image.bgr, out, cv::COLOR_BGR2GRAY);
  return out;
}

}  // namespace

HeadRegistration::HeadRegistration(const Rig& rig, const StereoLenses& lenses)
    : registration_(make_registration(*rig.calibration, lenses)) {
  std::vector<std::size_t> head;
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    if (rig.joints[i].group == JointGroup::pan_tilt) head.push_back(i);
  pan_ = head.at(0), tilt_ = head.at(1);
}

void HeadRegistration::add(const RobotStatus& status) {
  if (!status.all_homed) return;
  const std::lock_guard lock(mutex_);
  if (status.time <= newest_) return;
  newest_ = status.time;
  rows_.push_back({status.time, {status.feedback[pan_].position, status.feedback[tilt_].position}});
  if (rows_.size() > kMostRows) rows_.pop_front();
}

PairRegistration HeadRegistration::prepare() {
  const std::lock_guard lock(mutex_);
  return [this, known = newest_](const StereoPair& pair) { return register_pair(pair, known); };
}

RegisteredPose HeadRegistration::register_pair(const StereoPair& pair, RobotTime known) {
  {
    const std::lock_guard lock(mutex_);
    while (!rows_.empty() && rows_.front().time <= known) {
      registration_.add_encoders(rows_.front().time, rows_.front().encoders);
      rows_.pop_front();
    }
  }
  const RegistrationResult found = registration_.register_pair(pair.left.time, grey(pair.left), grey(pair.right));
  return {found.T_world_left, found.predicted_px, std::string(to_string(found.quality))};
}

}  // namespace foresight
