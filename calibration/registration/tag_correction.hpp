// The slow correction of the kinematics' poses, from all tag corners of the last moments.
//
//   residual of a corner X of the map in camera c of image k, one correction D for all k:
//     r = (lens_c(T_left_c^-1 (T_k D)^-1 X) - pixel) / sigma_k
//     sigma_k^2 = corner_px^2 + drift_px_per_s^2 * age_k * 1 s        a random walk since
//
// T_k: the left camera by the kinematics. All corners of both cameras stand in one problem; no pose of a
// single tag is ever formed. Huber's loss, then a gate: a tag whose eight residuals have a chi-square
// that happens once in a thousand is left out (moved, misread, bent) and the rest solved again. The
// prior is the kinematics' own covariance about D = 1, which is also the gauge where tags say little.
#pragma once

#include <deque>
#include <map>

#include "calibration/camera/twist.hpp"
#include "calibration/tags/tag_detector.hpp"
#include "common/time.hpp"
#include "scene/stereo_lenses.hpp"

namespace foresight {

/// Corners of the tags that stand still, world frame, metres, in DetectedTag's order; by id.
using TagMap = std::map<int, std::array<Eigen::Vector3d, 4>>;

struct TagCorrectionOptions {
  double lag_s = 0.4;           ///< window
  std::size_t most_images = 8;  ///< in it; of more the oldest go
  double corner_px = 0.15;      ///< standard deviation of a detected corner
  double drift_px_per_s = 2;    ///< how quickly the correction may change
  double gate = 26.1;           ///< chi-square of eight, 99.9 %
  int iterations = 6;
  Vector6d prior_sigma = (Vector6d() << 0.01, 0.01, 0.01, 0.01, 0.01, 0.01).finished();  ///< rad and m, of D
};

struct TagCorrectionSummary {
  Pose T_left_corrected = Pose::Identity();  ///< D
  Matrix6d covariance = Matrix6d::Zero();    ///< of D (twist.hpp), at the newest image
  int tags = 0;         ///< observations of tags that took part, all images and cameras of the window
  int gated = 0;        ///< that did not
  double rms_px = 0;    ///< of the corners that took part
  bool usable = false;  ///< at least one tag took part
};

/// One thread; images in ascending order.
class TagCorrection {
 public:
  TagCorrection(const StereoLenses& lenses, const TagMap& map, const TagCorrectionOptions& options);
  TagCorrection(const TagCorrection&) = delete;
  TagCorrection& operator=(const TagCorrection&) = delete;

  /// Tags of one image pair, and the left camera's pose by the kinematics.
  void add(RobotTime time, const Pose& T_world_left, const std::vector<DetectedTag>& left,
           const std::vector<DetectedTag>& right);

  /// Newest time at which a tag of the map was seen.
  std::optional<RobotTime> newest() const;

  TagCorrectionSummary solve(RobotTime now) const;

 private:
  struct Observation {  // of a tag in one image of one camera
    const std::array<Eigen::Vector3d, 4>* corners;
    std::array<Eigen::Vector2d, 4> pixels;
    bool right;
  };
  struct Image {
    RobotTime time;
    Pose T_world_left;
    std::vector<Observation> observations;
  };
  struct Problem;

  StereoLenses lenses_;
  Pose T_right_left_;
  TagMap map_;
  TagCorrectionOptions options_;
  std::deque<Image> images_;
};

}  // namespace foresight
