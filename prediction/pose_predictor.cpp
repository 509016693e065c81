#include "prediction/pose_predictor.hpp"

#include <algorithm>
#include <cmath>

#include "prediction/arm_chain.hpp"

namespace foresight {
namespace {

constexpr std::array kLags{0, 1, 2, 3, 4, 6, 8, 12};  // of kLag
constexpr double kLag = 1.0 / 60;                     // s
constexpr Eigen::Index kVelocities = static_cast<Eigen::Index>(kLags.size()) - 1;
constexpr double kReach = kLags.back() * kLag;
constexpr Eigen::Index kTurns = 2;   // newest angular velocities that move a point of the head
constexpr double kLever = 0.1;       // m: what makes their weights numbers about 1
constexpr double kUsualSpeed = 0.7;  // m/s and rad/s: with a second of moving so fast, a sample
constexpr double kUsualTurning = 3;  // counts as much as the prior does
constexpr double kSlack = 1.5;       // of the way at the fastest recent velocity: nothing goes farther

// Half the newest velocity and half the mean of 50 ms.
Weights velocity_prior(Eigen::Index size) {
  Weights prior = Weights::Zero(size);
  prior.head<3>().setConstant(1.0 / 6);
  prior[0] += 0.5;
  return prior;
}

Weights even_strength(Eigen::Index size, double way) {
  return Weights::Constant(size, way * way);
}

OnlineRegression regression(Eigen::Index size, double usual_way, double memory) {
  return {velocity_prior(size), even_strength(size, usual_way), memory};
}

Eigen::Vector3d limited(const Eigen::Vector3d& way, const Eigen::Ref<const Eigen::MatrixXd>& ways) {
  const double longest = kSlack * std::sqrt(ways.colwise().squaredNorm().maxCoeff()), length = way.norm();
  return length > longest ? Eigen::Vector3d(way * (longest / length)) : way;
}

Pose moved(const Pose& from, const Eigen::Vector3d& way, const Eigen::Vector3d& turn) {
  Pose to = from;
  const double angle = turn.norm();
  if (angle > 0) to.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * from.linear();
  to.translation() += way;
  return to;
}

}  // namespace

PosePredictor::PosePredictor(const PosePredictorOptions& options)
    : options_(options),
      trail_(options.trail),
      position_(regression(kVelocities + 3 * kTurns, kUsualSpeed * options.ahead, options.memory)),
      rotation_(regression(kVelocities, kUsualTurning * options.ahead, options.memory)),
      position_sigma_(0.05 * options.ahead / 0.1, 1e-5, 2, CalibratedSigma::kScaleOfThree),
      rotation_sigma_(0.1 * options.ahead / 0.1, 1e-5, 2, CalibratedSigma::kScaleOfThree) {}

PoseTaken PosePredictor::observe(OperatorTime time, const Pose& pose) noexcept {
  const PoseTaken taken = trail_.add(time, pose);
  if (taken == PoseTaken::invalid || taken == PoseTaken::late) return taken;
  if (taken == PoseTaken::anew)
    pending_.clear();
  else
    learn();
  predict();
  return taken;
}

// Of all poses whose instant of the future lies between the last two samples.
void PosePredictor::learn() noexcept {
  const auto& samples = trail_.samples();
  const auto &before = samples[samples.size() - 2], &now = samples.newest();
  position_.forget(now.stamp - before.stamp);
  rotation_.forget(now.stamp - before.stamp);
  for (; !pending_.empty() && pending_[0].stamp + options_.ahead <= now.stamp; pending_.drop_oldest()) {
    const Pending& was = pending_[0];
    const double seen = was.stamp + options_.ahead;
    if (seen < before.stamp) continue;  // the trail was shorter than that then
    const Pose truth = pose_between(before.pose, now.pose, (seen - before.stamp) / (now.stamp - before.stamp));
    const Vector6 way = pose_difference(was.pose, truth);
    const double since = std::clamp(was.stamp - learnt_until_, 0.0, options_.trail.largest_gap);
    learnt_until_ = was.stamp;
    position_sigma_.score((way.head<3>() - was.way).norm(), was.position_sigma, since);
    rotation_sigma_.score((way.tail<3>() - was.turn).norm(), was.rotation_sigma, since);
    if (!was.complete) continue;
    for (int axis = 0; axis < 3; ++axis) {
      position_.add(was.position.row(axis), way[axis]);
      rotation_.add(was.rotation.row(axis), way[3 + axis]);
    }
  }
}

void PosePredictor::predict() noexcept {
  Pending& now = pending_.next();
  now.stamp = trail_.samples().newest().stamp;
  now.pose = trail_.samples().newest().pose;
  now.complete = trail_.length() >= kReach;
  now.position.setZero(3, kVelocities + 3 * kTurns);
  now.rotation.setZero(3, kVelocities);
  Pose newer = now.pose;
  for (Eigen::Index k = 0; k < kVelocities; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double seconds = (kLags[i + 1] - kLags[i]) * kLag;
    const Pose older = trail_.back(kLags[i + 1] * kLag);
    const Vector6 way = pose_difference(older, newer) * (options_.ahead / seconds);
    now.position.col(k) = way.head<3>();
    now.rotation.col(k) = way.tail<3>();
    newer = older;
  }
  for (Eigen::Index k = 0; k < kTurns; ++k)
    for (int axis = 0; axis < 3; ++axis)
      now.position.col(kVelocities + 3 * k + axis) = kLever * now.rotation.col(k).cross(now.pose.linear().col(axis));
  now.way = limited(now.position * position_.weights(), now.position.leftCols<kVelocities>());
  now.turn = limited(now.rotation * rotation_.weights(), now.rotation);
  now.position_sigma = start_sigma(position_sigma_.sigma());
  now.rotation_sigma = start_sigma(rotation_sigma_.sigma());
}

// A trail that has just begun knows less of velocities.
double PosePredictor::start_sigma(double usual) const noexcept {
  return usual * (1 + 4 * std::max(0.0, 1 - trail_.length() / kReach));
}

PosePrediction PosePredictor::at(OperatorTime time) const noexcept {
  PosePrediction answer;
  if (pending_.empty()) return answer;
  const Pending& now = pending_.newest();
  const double ahead = to_seconds(time - trail_.samples().newest().time);
  if (!(ahead >= 0 && ahead <= options_.farthest)) return answer;
  // Nearer than learnt for: the parabola that leaves at the present velocity and ends where the learnt way does.
  const double share = ahead / options_.ahead, bend = std::min(share, 1.0) * share;
  const Weights start = velocity_prior(kVelocities);
  const Eigen::Vector3d way = now.position.leftCols<kVelocities>() * start, turn = now.rotation * start;
  answer.pose = moved(now.pose, share * way + bend * (now.way - way), share * turn + bend * (now.turn - turn));
  answer.status = ahead == 0 ? StateStatus::exact : StateStatus::predicted;
  answer.position_sigma = now.position_sigma * std::pow(share, 1.5);
  answer.rotation_sigma = now.rotation_sigma * std::pow(share, 1.5);
  return answer;
}

}  // namespace foresight
