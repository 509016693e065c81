#include "calibration/robot/stream_alignment.hpp"

#include <algorithm>

#include "calibration/robot/hand_eye_start.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/rotation.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kStep = 0.01;       // of the search, seconds
constexpr double kHalfWindow = 0.1;  // over which a speed is measured
constexpr double kLeastCommon = 3;   // seconds
constexpr double kMargin = 0.05;     // around a sample in which the offset may still move

constexpr double kLeastSpeed = 0.01;  // rad/s: a hand that turns less stands still

struct Speeds {
  double first_s = 0;
  std::vector<double> values;  // every kStep; NaN where unknown
  double high = 0;             // the 80th percentile; 0 where nothing is known
};

// Angular speed of a track, cut at twice the 80th percentile: jumps of a tracker would outweigh all else.
Speeds speeds_of(const PoseTrack& track, RobotTime zero) {
  Speeds out;
  out.first_s = to_seconds(track.samples().front().time - zero);
  const double last = to_seconds(track.samples().back().time - zero);
  std::vector<double> known;
  for (double t = out.first_s; t <= last; t += kStep) {
    const auto a = track.at(zero + seconds(t - kHalfWindow), Duration{0}),
               b = track.at(zero + seconds(t + kHalfWindow), Duration{0});
    const bool valid = a.status != StateStatus::invalid && b.status != StateStatus::invalid;
    const double turn = valid ? rotation_vector(a.pose.linear().transpose() * b.pose.linear()).norm() : NAN;
    out.values.push_back(turn / (2 * kHalfWindow));
    if (valid) known.push_back(out.values.back());
  }
  if (known.empty()) return out;
  out.high = quantile(std::move(known), 0.8);
  for (double& value : out.values)
    if (value > 2 * out.high) value = 2 * out.high;
  return out;
}

// Pearson's correlation of what both know; -2 where that is too little.
double correlation(const Speeds& a, const Speeds& b, long shift, std::size_t stride) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const long size = static_cast<long>(a.values.size());
  for (std::size_t i = 0; i < b.values.size(); i += stride) {
    const long j = static_cast<long>(i) + shift;
    if (j < 0 || j >= size) continue;
    const double x = a.values[static_cast<std::size_t>(j)], y = b.values[i];
    if (!(x >= 0) || !(y >= 0)) continue;
    ++n, sa += x, sb += y, saa += x * x, sbb += y * y, sab += x * y;
  }
  if (n * kStep * static_cast<double>(stride) < kLeastCommon) return -2;
  const double va = saa - sa * sa / n, vb = sbb - sb * sb / n;
  return va > 1e-12 && vb > 1e-12 ? (sab - sa * sb / n) / std::sqrt(va * vb) : -1;
}

[[noreturn]] void refuse_overlap(const PoseTrack& encoder, const PoseTrack& camera, const TimeOffsetOptions& options) {
  const auto span = [](const PoseTrack& track) {
    return readable(to_seconds(Duration{track.samples().front().time.ns}), 3) + " to " +
           readable(to_seconds(Duration{track.samples().back().time.ns}), 3) + " s";
  };
  throw InputError("--camera-poses",
                   "the streams share less than 3 s of known motion: encoders " + span(encoder) + ", camera " +
                       span(camera) + ", offsets up to " + readable(options.largest_offset_s, 1) + " s around " +
                       readable(options.around_s, 3) + " s",
                   "give streams of one session, or the rough offset by --around");
}

void require_turning(const Speeds& speeds, const PoseTrack& track, const std::string& option, const std::string& name) {
  const auto& samples = track.samples();
  if (speeds.high >= kLeastSpeed) return;
  if (speeds.high > 0 || std::any_of(speeds.values.begin(), speeds.values.end(), [](double v) { return v >= 0; }))
    throw InputError(option, name + " hardly turn: " + readable(57.29578 * speeds.high, 2) + " degrees/s",
                     "turn the hand to and fro about two axes, by 30 degrees and more");
  const double span = to_seconds(samples.back().time - samples.front().time);
  throw InputError(
      option,
      counted(samples.size(), "row") + " within " + readable(span, 3) + " s " +
          (span < 2 * kHalfWindow ? "are too short a stream" : "lie more than 0.2 s apart from each other"),
      "give 10 poses a second and more, times in one unit (--time-unit)");
}

// Rotation of hand <- camera from turns over about 0.3 s, twice without what fits badly.
Eigen::Matrix3d wahba(const std::vector<AlignedPose>& poses) {
  std::vector<Eigen::Vector3d> hand, camera;
  for (std::size_t i = 0, j = 0; j < poses.size(); ++j) {
    while (poses[j].time_s - poses[i].time_s > 0.3) ++i;
    if (i == j) continue;
    hand.push_back(rotation_vector(poses[i].encoder.linear().transpose() * poses[j].encoder.linear()));
    camera.push_back(
        rotation_vector(poses[i].T_camera_target.linear() * poses[j].T_camera_target.linear().transpose()));
  }
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double limit = 1e300;
  for (int round = 0; round < 4; ++round) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    std::vector<double> off;
    for (std::size_t k = 0; k < hand.size(); ++k)
      if (round == 0 || (hand[k] - R * camera[k]).norm() < limit) sum += hand[k] * camera[k].transpose();
    R = nearest_rotation(sum);
    for (std::size_t k = 0; k < hand.size(); ++k) off.push_back((hand[k] - R * camera[k]).norm());
    limit = 4 * median(off);
  }
  return R;
}

}  // namespace

Lag correlate_speeds(const PoseTrack& encoder, const PoseTrack& camera, const TimeOffsetOptions& options) {
  const RobotTime zero = encoder.samples().front().time;
  const Speeds a = speeds_of(encoder, zero), b = speeds_of(camera, zero);
  require_turning(a, encoder, "--poses", "the encoders' poses");
  require_turning(b, camera, "--camera-poses", "the camera's poses");
  const std::size_t stride = std::max<std::size_t>(1, b.values.size() / 60'000);
  const double fraction = (b.first_s - a.first_s) / kStep;
  const long whole = std::lround(fraction);
  const long around = std::lround(options.around_s / kStep), reach = std::lround(options.largest_offset_s / kStep);
  Lag best;
  best.correlation = -2;
  long at = 0;
  for (long k = around - reach; k <= around + reach; ++k) {
    const double r = correlation(a, b, whole + k, stride);
    if (r < -1.5) continue;
    best.lags_s.push_back((static_cast<double>(whole + k) - fraction) * kStep);
    best.correlations.push_back(r);
    if (r > best.correlation) best.correlation = r, at = static_cast<long>(best.lags_s.size()) - 1;
  }
  if (best.lags_s.empty()) refuse_overlap(encoder, camera, options);
  const auto i = static_cast<std::size_t>(at);
  best.offset_s = best.lags_s[i];
  if (i > 0 && i + 1 < best.lags_s.size()) {
    const double l = best.correlations[i - 1], m = best.correlations[i], r = best.correlations[i + 1];
    if (const double bend = l - 2 * m + r; bend < 0)
      best.offset_s += kStep * std::clamp(0.5 * (l - r) / bend, -0.5, 0.5);
  }
  return best;
}

std::vector<AlignedPose> aligned_poses(const PoseTrack& encoder, const PoseTrack& camera, double offset_s,
                                       bool camera_inverted, std::size_t most) {
  std::vector<AlignedPose> all;
  const RobotTime zero = encoder.samples().front().time;
  for (const PoseTrack::Sample& sample : camera.samples()) {
    const RobotTime t = sample.time + seconds(offset_s);
    const auto now = encoder.at(t, Duration{0});
    const bool known = now.status != StateStatus::invalid &&
                       encoder.at(t - seconds(kMargin), Duration{0}).status != StateStatus::invalid &&
                       encoder.at(t + seconds(kMargin), Duration{0}).status != StateStatus::invalid;
    if (!known) continue;
    all.push_back({to_seconds(sample.time - zero), now.pose, camera_inverted ? sample.pose : sample.pose.inverse()});
  }
  if (all.size() <= most) return all;
  std::vector<AlignedPose> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

StreamHandEye stream_hand_eye(const std::vector<AlignedPose>& poses, bool rotation_only) {
  StreamHandEye out;
  if (!rotation_only) {
    std::vector<RobotPose> robot;
    std::vector<Pose> seen;
    const std::size_t stride = std::max<std::size_t>(1, poses.size() / 80);
    for (std::size_t i = 0; i < poses.size(); i += stride)
      robot.push_back({poses[i].encoder, {}}), seen.push_back(poses[i].T_camera_target);
    const std::vector<Pose> same{Pose::Identity()};
    const HandEyeStart start = start_hand_eye(CameraMount::moving, robot, seen, same);
    return {start.X, start.Y, start.misfit_m};
  }
  out.X.linear() = wahba(poses);
  std::vector<Pose> targets;
  for (const AlignedPose& pose : poses) {
    targets.push_back(Pose::Identity());
    targets.back().linear() = pose.encoder.linear() * out.X.linear() * pose.T_camera_target.linear();
  }
  out.Y = typical_pose(targets);
  std::vector<double> off;
  for (const Pose& target : targets) off.push_back(misfit_m(out.Y, target));
  out.misfit = median(off);
  return out;
}

}  // namespace foresight
