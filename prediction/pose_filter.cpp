#include "prediction/pose_filter.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>

namespace foresight {
namespace {

constexpr std::array kHandLags{0, 1, 2, 3, 4, 6, 8};  // of kHandLag
constexpr double kHandLag = 1.0 / 60;                 // s
constexpr Eigen::Index kBends = static_cast<Eigen::Index>(kHandLags.size()) - 2;
constexpr double kHandReach = kHandLags.back() * kHandLag;
constexpr double kFirm = 0.003;  // m and rad: with bends of the path of that size, a sample counts as the prior does

OnlineRegression regression(double memory) {
  return {Weights::Zero(kBends), Weights::Constant(kBends, kFirm * kFirm), memory};
}

}  // namespace

std::optional<Vector6> offset_to_smooth(const LastOf<PoseTrail::Sample>& samples, std::size_t i) noexcept {
  const PoseTrail::Sample& middle = samples[i];
  std::size_t first = i, last = i;
  while (first > 0 && middle.even - samples[first - 1].even <= kFilterSide) --first;
  while (last + 1 < samples.size() && samples[last + 1].even - middle.even <= kFilterSide) ++last;
  if (i - first < 2 || last - i < 2) return {};
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> b = Eigen::Matrix<double, 3, 6>::Zero();
  for (std::size_t k = first; k <= last; ++k) {
    const double t = (samples[k].even - middle.even) / kFilterSide;
    const Eigen::Vector3d powers(1, t, t * t);
    A += powers * powers.transpose();
    b += powers * pose_difference(middle.pose, samples[k].pose).transpose();
  }
  const Vector6 offset = A.ldlt().solve(b).row(0).transpose();
  if (!offset.allFinite()) return {};
  return offset;
}

PoseFilter::PoseFilter(const PoseFilterOptions& options)
    : trail_(options.trail), position_(regression(options.memory)), rotation_(regression(options.memory)) {}

PoseTaken PoseFilter::observe(OperatorTime time, const Pose& pose) noexcept {
  const double before = trail_.samples().empty() ? 0 : trail_.samples().newest().stamp;
  const PoseTaken taken = trail_.add(time, pose);
  if (taken == PoseTaken::invalid || taken == PoseTaken::late) return taken;
  filtered_ = pose;
  if (taken == PoseTaken::anew) {
    pending_.clear();
    return taken;
  }
  position_.forget(trail_.samples().newest().stamp - before);
  rotation_.forget(trail_.samples().newest().stamp - before);
  learn();
  if (trail_.length() < kHandReach) return taken;
  Pending& now = pending_.next();
  now.even = trail_.samples().newest().even;
  now.inputs = inputs();
  const Eigen::Vector3d way = now.inputs.topRows<3>() * position_.weights();
  const Eigen::Vector3d turn = now.inputs.bottomRows<3>() * rotation_.weights();
  filtered_.translation() += way;
  const double angle = turn.norm();
  if (angle > 0) filtered_.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * pose.linear();
  return taken;
}

PoseFilter::Inputs PoseFilter::inputs() const noexcept {
  Inputs bends(6, kBends);
  Pose newer = trail_.samples().newest().pose;
  Vector6 velocity = Vector6::Zero();
  for (std::size_t k = 0; k + 1 < kHandLags.size(); ++k) {
    const Pose older = trail_.back(kHandLags[k + 1] * kHandLag);
    const Vector6 earlier = pose_difference(older, newer) / (kHandLags[k + 1] - kHandLags[k]);  // per kHandLag
    if (k > 0) bends.col(static_cast<Eigen::Index>(k) - 1) = velocity - earlier;
    velocity = earlier;
    newer = older;
  }
  return bends;
}

void PoseFilter::learn() noexcept {
  const auto& samples = trail_.samples();
  std::size_t i = 0;
  for (; !pending_.empty() && samples.newest().even - pending_[0].even > kFilterSide; pending_.drop_oldest()) {
    const Pending& was = pending_[0];
    while (i < samples.size() && samples[i].even < was.even) ++i;
    if (i == samples.size() || samples[i].even != was.even) continue;
    const auto offset = offset_to_smooth(samples, i);
    if (!offset) continue;
    for (int axis = 0; axis < 3; ++axis) {
      position_.add(was.inputs.row(axis), (*offset)[axis]);
      rotation_.add(was.inputs.row(3 + axis), (*offset)[3 + axis]);
    }
  }
}

}  // namespace foresight
