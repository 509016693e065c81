#include "calibration/registration/registration.hpp"

#include <Eigen/Cholesky>

namespace foresight {
namespace {

constexpr double kSixAt999 = 22.46;  // chi-square of six, 99.9 %

/// Mean over the image of how a point `depth` metres away moves, squared, per twist.
Matrix6d px_metric(const Lens& lens, double depth) {
  constexpr int kAcross = 8, kDown = 6;
  constexpr double kStep = 1e-6;
  Matrix6d sum = Matrix6d::Zero();
  int count = 0;
  for (int i = 0; i < kAcross * kDown; ++i) {
    const auto ray =
        lens.unproject({(i % kAcross + 0.5) * lens.width() / kAcross, (i / kAcross + 0.5) * lens.height() / kDown});
    if (!ray || ray->z() < 0.1) continue;
    const Eigen::Vector3d p = *ray * (depth / ray->z());
    Eigen::Matrix<double, 2, 6> slope;
    bool seen = true;
    for (int axis = 0; axis < 6 && seen; ++axis) {
      const auto after = lens.project(to_motion(kStep * Vector6d::Unit(axis)).inverse() * p),
                 before = lens.project(to_motion(-kStep * Vector6d::Unit(axis)).inverse() * p);
      seen = after && before;
      if (seen) slope.col(axis) = (*after - *before) / (2 * kStep);
    }
    if (!seen) continue;
    sum += slope.transpose() * slope;
    ++count;
  }
  return sum / std::max(1, count);
}

}  // namespace

std::string_view to_string(RegistrationQuality quality) {
  switch (quality) {
    case RegistrationQuality::tags: return "tags";
    case RegistrationQuality::held: return "held";
    case RegistrationQuality::encoders: return "encoders";
    case RegistrationQuality::lost: break;
  }
  return "lost";
}

Registration::Registration(const HeadModel& head, const StereoLenses& lenses, const TagMap& map,
                           const RegistrationOptions& options)
    : head_(head),
      lenses_(lenses),
      options_(options),
      track_(head, options.encoders),
      detector_(options.detector),
      correction_(lenses, map, options.correction),
      px_metric_(px_metric(lenses.left, options.scene_m)) {}

RegistrationResult Registration::register_pair(RobotTime camera_time, const cv::Mat& left, const cv::Mat& right) {
  const auto detect = [&](const cv::Mat& image) {
    return image.empty() ? std::vector<DetectedTag>{} : detector_.detect(image);
  };
  const std::vector<DetectedTag> in_left = detect(left);
  return register_tags(camera_time, in_left, detect(right));
}

/// What the kinematics does not know: the model's own errors, the shafts', and their speed times the clocks' error.
Matrix6d Registration::kinematic_covariance(const EncoderTrack::Answer& at) const {
  constexpr double kStep = 1e-6;
  const Pose T_camera_world = T_world_camera(head_, at.shafts).inverse();
  const auto slope = [&](const HeadAngles& direction) {
    const HeadAngles moved{at.shafts.pan + kStep * direction.pan, at.shafts.tilt + kStep * direction.tilt};
    return Vector6d(to_twist(T_camera_world * T_world_camera(head_, moved)) / kStep);
  };
  const Vector6d pan = slope({1, 0}), tilt = slope({0, 1}), moving = slope(at.rate) * head_.sigma_offset_s;
  const Matrix6d model = head_.sigma_pose.array().square().matrix().asDiagonal();
  // What tags last found to be wrong with the model is wrong with it until they say otherwise.
  const Vector6d found = held_ ? to_twist(held_->summary.T_left_corrected) : Vector6d::Zero();
  return model + found * found.transpose() + moving * moving.transpose() +
         head_.sigma_rad * head_.sigma_rad * (pan * pan.transpose() + tilt * tilt.transpose());
}

double Registration::px(const Matrix6d& covariance) const {
  return std::sqrt(std::max(0.0, (px_metric_ * covariance).trace()));
}

/// An old correction is worth something as long as it is surer than none.
void Registration::hold(RobotTime time, RegistrationResult& result, const Matrix6d& kinematic) const {
  if (!held_) return;
  const double age = to_seconds(time - held_->time);
  const double drift = options_.correction.drift_px_per_s * options_.correction.drift_px_per_s * age;
  const Matrix6d covariance = held_->summary.covariance + drift * px_metric_.ldlt().solve(Matrix6d::Identity()) / 6;
  if (px(covariance) >= px(kinematic)) return;
  result.quality = RegistrationQuality::held;
  result.covariance = covariance;
  result.T_world_left = result.T_world_left * held_->summary.T_left_corrected;
}

RegistrationResult Registration::register_tags(RobotTime camera_time, const std::vector<DetectedTag>& left,
                                               const std::vector<DetectedTag>& right) {
  RegistrationResult result;
  const EncoderTrack::Answer at = track_.at(camera_time);
  if (at.status == StateStatus::invalid) {
    result.T_world_left = last_;
    result.T_world_right = last_ * lenses_.T_left_right;
    result.covariance = Matrix6d::Identity();
    result.predicted_px = px(result.covariance);
    return result;
  }
  result.T_world_left = T_world_camera(head_, at.shafts);
  correction_.add(camera_time, result.T_world_left, left, right);
  if (correction_.newest()) result.tags = correction_.solve(camera_time);
  const Matrix6d kinematic = kinematic_covariance(at);
  result.quality = RegistrationQuality::encoders;
  result.covariance = kinematic;
  if (result.tags.usable) {
    result.quality = RegistrationQuality::tags;
    result.covariance = result.tags.covariance;
    result.T_world_left = result.T_world_left * result.tags.T_left_corrected;
    held_ = {*correction_.newest(), result.tags};
  } else {
    hold(camera_time, result, kinematic);
  }
  result.predicted_px = px(result.covariance);
  result.T_world_right = result.T_world_left * lenses_.T_left_right;
  last_ = result.T_world_left;
  return result;
}

std::optional<Pose> Registration::moved(RobotTime camera_time, const Pose& T_world_left, RobotTime other_time) const {
  if (other_time == camera_time) return T_world_left;
  const EncoderTrack::Answer before = track_.at(camera_time), after = track_.at(other_time);
  if (before.status == StateStatus::invalid || after.status == StateStatus::invalid) return std::nullopt;
  return T_world_camera(head_, after.shafts) * T_world_camera(head_, before.shafts).inverse() * T_world_left;
}

bool Registration::agrees_with_tags(const RegistrationResult& result, const Pose& refined, const Matrix6d& covariance) {
  if (!result.tags.usable) return true;
  const Vector6d difference = to_twist(result.T_world_left.inverse() * refined);
  const Matrix6d both = result.covariance + covariance;
  return difference.dot(both.ldlt().solve(difference)) <= kSixAt999;
}

}  // namespace foresight
