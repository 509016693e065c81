#include "calibration/registration/tag_veto.hpp"

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "calibration/registration/registration.hpp"

namespace foresight {
namespace {

constexpr double kCornerPx = 0.3;  // of one corner, and of all of them together

}  // namespace

TagVeto::TagVeto(const StereoLenses& lenses, TagMap map, const TagDetector::Options& detector)
    : lenses_(lenses), map_(std::move(map)), detector_(detector) {}

std::vector<DetectedTag> TagVeto::detect(const cv::Mat& image) {
  if (image.empty()) return {};
  if (image.channels() == 1) return detector_.detect(image);
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return detector_.detect(grey);
}

TagVerdict TagVeto::judge(const RefinedPose& pose, const cv::Mat& left, const cv::Mat& right) {
  const std::vector<DetectedTag> in_left = detect(left);
  return judge(pose, in_left, detect(right));
}

TagVerdict TagVeto::judge(const RefinedPose& pose, const std::vector<DetectedTag>& left,
                          const std::vector<DetectedTag>& right) const {
  TagCorrectionOptions options;
  options.corner_px = kCornerPx;
  TagCorrection correction(lenses_, map_, options);
  const RobotTime now;
  correction.add(now, pose.T_world_left, left, right);
  if (!correction.newest()) return TagVerdict::unseen;
  RegistrationResult by_tags;
  by_tags.tags = correction.solve(now);
  if (!by_tags.tags.usable) return TagVerdict::unseen;
  by_tags.T_world_left = pose.T_world_left * by_tags.tags.T_left_corrected;
  // One corner's information, spread over the six: the error that all corners share.
  by_tags.covariance = (1 + 4.0 * by_tags.tags.tags / 6) * by_tags.tags.covariance;
  if (Registration::agrees_with_tags(by_tags, pose.T_world_left, pose.covariance)) return TagVerdict::agree;
  const auto misfit = [&, information = by_tags.tags.covariance.ldlt()](const Pose& T_world_left) {
    const Vector6d off = to_twist(by_tags.T_world_left.inverse() * T_world_left);
    return off.dot(information.solve(off));
  };
  return misfit(pose.T_world_given) < misfit(pose.T_world_left) ? TagVerdict::object : TagVerdict::agree;
}

}  // namespace foresight
