// May a pose that was refined against a model stay, in sight of tags that stand still?
//
//   D: what the tags of this image pair alone would still change about the refined pose (tag_correction.hpp)
//   contradicted where  t^T (C_tags + C_refined)^-1 t > 22.46,   t: D as a twist, chi-square of six, 99.9 %
//
// All corners may err alike: corners of real cameras lie up to 0.3 px towards the middle of their tag, and a map
// has errors of its own. So C_tags is that of one shared error of 0.3 px, which no number of tags averages out,
// on top of the noise. It follows that a D that moves the corners by less than 0.58 px, root mean
// square, never contradicts anything.
#pragma once

#include "calibration/registration/tag_correction.hpp"

namespace foresight {

enum class TagVerdict {
  unseen,  ///< no tag of the map is seen, or none that fits any pose nearby
  agree,   ///< the refined pose is within what tags can tell, or fits them no worse than the given one
  object,  ///< it is not, and the given pose fits the tags better
};

struct RefinedPose {
  Pose T_world_given = Pose::Identity();
  Pose T_world_left = Pose::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of a small motion of the left camera, its own frame (twist.hpp)
};

/// One thread.
class TagVeto {
 public:
  TagVeto(const StereoLenses& lenses, TagMap map, const TagDetector::Options& detector);

  /// CV_8UC1 or CV_8UC3 of the lenses' sizes; an empty one is a camera without an image.
  TagVerdict judge(const RefinedPose& pose, const cv::Mat& left, const cv::Mat& right);

  /// The same from tags that are found already.
  TagVerdict judge(const RefinedPose& pose, const std::vector<DetectedTag>& left,
                   const std::vector<DetectedTag>& right) const;

 private:
  std::vector<DetectedTag> detect(const cv::Mat& image);

  StereoLenses lenses_;
  TagMap map_;
  TagDetector detector_;
};

}  // namespace foresight
