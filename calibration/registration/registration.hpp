// The pose of both cameras at an image pair's capture instant.
//
//   encoders --> kinematics --> T_left --.
//   images --> tags --> slow correction D --> T_world_left = T_left * D, covariance, expected px
//
// A refinement against the rendered model (photometric_refinement.hpp) may follow; agrees_with_tags()
// tells whether it may stay.
#pragma once

#include <string_view>

#include "calibration/registration/head_kinematics.hpp"
#include "calibration/registration/tag_correction.hpp"

namespace foresight {

enum class RegistrationQuality {
  tags,      ///< corrected by tags of the last moments
  held,      ///< corrected by tags seen earlier: more certain than the encoders alone all the same
  encoders,  ///< no tag has helped, or too long ago
  lost,      ///< no encoders for this instant: the pose is the last one, without meaning
};

std::string_view to_string(RegistrationQuality quality);

struct RegistrationOptions {
  TagDetector::Options detector;
  TagCorrectionOptions correction;
  EncoderTrack::Options encoders;
  double scene_m = 1;  ///< usual distance of the scene, for predicted_px; > 0
};

struct RegistrationResult {
  Pose T_world_left = Pose::Identity();
  Pose T_world_right = Pose::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of a small motion of the left camera (twist.hpp), its own frame
  double predicted_px = 0;  ///< root mean square over the left image of how far scene points are off, by one sigma
  RegistrationQuality quality = RegistrationQuality::lost;
  TagCorrectionSummary tags;  ///< of the last moments; see its `usable`
};

/// One thread. Encoders may come at any rate, each with its own instants, also later than the images they belong to, as
/// long as they are there when the images are registered.
class Registration {
 public:
  /// Throws InputError for what the detector refuses.
  Registration(const HeadModel& head, const StereoLenses& lenses, const TagMap& map,
               const RegistrationOptions& options);

  bool add_encoders(RobotTime encoder_time, const HeadAngles& encoders) { return track_.add(encoder_time, encoders); }
  /// Encoders that tell their positions at instants of their own.
  bool add_pan(RobotTime encoder_time, double encoder) { return track_.add_pan(encoder_time, encoder); }
  bool add_tilt(RobotTime encoder_time, double encoder) { return track_.add_tilt(encoder_time, encoder); }

  /// CV_8UC1 of the lenses' sizes; an empty one is a camera without an image. Times ascend.
  RegistrationResult register_pair(RobotTime camera_time, const cv::Mat& left, const cv::Mat& right);

  /// The same from tags that are found already.
  RegistrationResult register_tags(RobotTime camera_time, const std::vector<DetectedTag>& left,
                                   const std::vector<DetectedTag>& right);

  /// Where the left camera is at another instant, if at `camera_time` it was at `T_world_left`: moved as the encoders
  /// say. Nothing where they do not know.
  std::optional<Pose> moved(RobotTime camera_time, const Pose& T_world_left, RobotTime other_time) const;

  const HeadModel& head() const { return head_; }

  /// Is `refined` within what `result` can tell from tags (chi-square of six, 99.9 %, with the
  /// refinement's own covariance)? Always where no tags helped.
  static bool agrees_with_tags(const RegistrationResult& result, const Pose& refined, const Matrix6d& covariance);

 private:
  Matrix6d kinematic_covariance(const EncoderTrack::Answer& shafts) const;
  double px(const Matrix6d& covariance) const;
  void hold(RobotTime time, RegistrationResult& result, const Matrix6d& kinematic) const;

  HeadModel head_;
  StereoLenses lenses_;
  RegistrationOptions options_;
  EncoderTrack track_;
  TagDetector detector_;
  TagCorrection correction_;
  Matrix6d px_metric_;
  struct Held {
    RobotTime time;
    TagCorrectionSummary summary;
  };
  std::optional<Held> held_;
  Pose last_ = Pose::Identity();
};

}  // namespace foresight
