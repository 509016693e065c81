#include "calibration/robot/time_offset.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>

#include <algorithm>

#include "calibration/camera/minimise.hpp"
#include "calibration/camera/rigid_motion.hpp"
#include "calibration/robot/motion_check.hpp"
#include "calibration/robot/stream_alignment.hpp"
#include "calibration/robot/time_covariance.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestSamples = 50;
constexpr double kLeastCorrelation = 0.4;
constexpr double kCauchy = 3;               // of Cauchy's loss, standard deviations of a six-vector
constexpr double kSmallestTurn = 0.1;       // rad, of swept joints
constexpr double kShortestStretch = 1;      // s: shorter ones are not independent
constexpr double kLargestSigma = 1.0 / 60;  // s
constexpr double kLargestStep = 0.15;       // s, from the correlation's offset to the refined one

// Encoder samples as doubles since the first, with the turn to the next one.
struct Track {
  std::vector<double> time;
  std::vector<Eigen::Quaterniond> q;
  std::vector<Eigen::Vector3d> p, turn;

  explicit Track(const std::vector<PoseTrack::Sample>& samples) {
    for (const PoseTrack::Sample& sample : samples) {
      time.push_back(to_seconds(sample.time - samples.front().time));
      q.emplace_back(sample.pose.linear());
      p.push_back(sample.pose.translation());
    }
    for (std::size_t i = 0; i + 1 < q.size(); ++i)
      turn.push_back(rotation_vector((q[i].conjugate() * q[i + 1]).toRotationMatrix()));
  }

  std::size_t bracket(double t) const {
    const auto next = std::upper_bound(time.begin() + 1, time.end() - 1, t);
    return static_cast<std::size_t>(next - time.begin()) - 1;
  }
};

double value(double x) {
  return x;
}
template <typename T, int N>
double value(const ceres::Jet<T, N>& x) {
  return x.a;
}

// Turn (rad) and shift (m) from the predicted to the measured target, in the camera, over their noise.
struct StreamResidual {
  const Track& track;
  double time_s;
  Eigen::Quaterniond q_camera_target;
  Eigen::Vector3d p_camera_target;
  double weight_turn, weight_shift;

  template <typename T>
  bool operator()(const T* offset, const T* X, const T* Y, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const T t = T(time_s) + offset[0];
    const std::size_t k = track.bracket(value(t));
    const T s = (t - T(track.time[k])) / T(track.time[k + 1] - track.time[k]);
    const Vector half_way = track.turn[k].cast<T>() * s;
    T q_step[4];
    ceres::AngleAxisToQuaternion(half_way.data(), q_step);
    const Eigen::Quaternion<T> q_hand =
        track.q[k].cast<T>() * Eigen::Quaternion<T>(q_step[0], q_step[1], q_step[2], q_step[3]);
    const Vector p_hand = track.p[k].cast<T>() + s * (track.p[k + 1] - track.p[k]).cast<T>();

    const Eigen::Map<const Eigen::Quaternion<T>> qX(X), qY(Y);
    const Eigen::Map<const Vector> pX(X + 4), pY(Y + 4);
    const Vector p_in_hand = q_hand.conjugate() * (pY - p_hand) - pX;
    const Vector p = qX.conjugate() * p_in_hand;
    const Eigen::Quaternion<T> q = qX.conjugate() * (q_hand.conjugate() * qY);
    const Eigen::Quaternion<T> off = q.conjugate() * q_camera_target.cast<T>();
    const T wxyz[4] = {off.w(), off.x(), off.y(), off.z()};
    ceres::QuaternionToAngleAxis(wxyz, residual);
    for (int i = 0; i < 3; ++i) {
      residual[i] *= T(weight_turn);
      residual[3 + i] = (T(p_camera_target[i]) - p[i]) * T(weight_shift);
    }
    return true;
  }
};

struct State {
  double offset = 0;
  MotionParameters X{}, Y{};
  double sigma_turn = 0.01, sigma_shift = 0.005;
};

void build(const Track& track, const std::vector<AlignedPose>& poses, bool rotation_only, State& state,
           ceres::Problem& problem) {
  for (const AlignedPose& pose : poses) {
    auto* functor = new StreamResidual{track,
                                       pose.time_s,
                                       Eigen::Quaterniond(pose.T_camera_target.linear()),
                                       pose.T_camera_target.translation(),
                                       1 / state.sigma_turn,
                                       rotation_only ? 0 : 1 / state.sigma_shift};
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<StreamResidual, 6, 1, 7, 7>(functor),
                             new ceres::CauchyLoss(kCauchy), &state.offset, state.X.data(), state.Y.data());
  }
  problem.SetManifold(state.X.data(), motion_manifold());
  problem.SetManifold(state.Y.data(), motion_manifold());
}

std::vector<double> residuals_of(ceres::Problem& problem, const State& state) {
  ceres::Problem::EvaluateOptions options;
  options.apply_loss_function = false;
  std::vector<double> r;
  problem.Evaluate(options, nullptr, &r, nullptr, nullptr);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] *= i % 6 < 3 ? state.sigma_turn : state.sigma_shift;
  return r;
}

// Minimises, and takes the noises from the residuals, until they settle.
void refine(const Track& track, const std::vector<AlignedPose>& poses, bool rotation_only, State& state) {
  for (int round = 0; round < 10; ++round) {
    ceres::Problem problem;
    build(track, poses, rotation_only, state, problem);
    MinimiseOptions options;
    options.solver = ceres::DENSE_NORMAL_CHOLESKY;
    options.most_iterations = 60;
    options.function_tolerance = 1e-6;
    options.threads = 2;
    minimise_or_throw(problem, options, "the time offset", "check that both streams belong together");
    const std::vector<double> r = residuals_of(problem, state);
    std::vector<double> turns, shifts;
    for (std::size_t i = 0; i < r.size(); ++i) (i % 6 < 3 ? turns : shifts).push_back(r[i]);
    const double turn = std::max(1e-6, robust_sigma(turns)), shift = std::max(1e-6, robust_sigma(shifts));
    const bool settled =
        std::abs(turn - state.sigma_turn) < 0.01 * turn && std::abs(shift - state.sigma_shift) < 0.01 * shift;
    state.sigma_turn = turn, state.sigma_shift = rotation_only ? 1 : shift;
    if (settled) return;
  }
}

Eigen::MatrixXd covariance_of(ceres::Problem& problem, const std::vector<AlignedPose>& poses, double segment_s,
                              State& state, TimeOffsetSummary& summary) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = {&state.offset, state.X.data(), state.Y.data()};
  std::vector<double> r, times;
  ceres::CRSMatrix J;
  problem.Evaluate(options, nullptr, &r, nullptr, &J);
  for (const AlignedPose& pose : poses) times.insert(times.end(), 6, pose.time_s);
  const StretchCovariance found = stretch_covariance(J, r, times, segment_s);
  summary.segments = found.stretches;
  return found.covariance;
}

void measure_scatter(const Track& track, const std::vector<AlignedPose>& poses, const PoseTrack& encoder,
                     bool rotation_only, TimeOffsetSummary& summary) {
  std::vector<Pose> targets;
  for (const AlignedPose& pose : poses) {
    const RobotTime t = encoder.samples().front().time + seconds(pose.time_s + summary.offset_s);
    targets.push_back(encoder.at(t, Duration{0}).pose * summary.X * pose.T_camera_target);
    summary.residual_time_s.push_back(pose.time_s - poses.front().time_s);
  }
  const Pose typical = typical_pose(targets);
  for (const Pose& target : targets) {
    summary.residual_mm.push_back(rotation_only ? 0 : 1e3 * (target.translation() - typical.translation()).norm());
    summary.residual_mrad.push_back(1e3 * rotation_vector(typical.linear().transpose() * target.linear()).norm());
  }
  summary.scatter_mm = median(summary.residual_mm);
  summary.scatter_mrad = median(summary.residual_mrad);
  for (std::size_t i = 0; i < targets.size(); ++i)
    summary.outliers += summary.residual_mrad[i] > 5 * summary.scatter_mrad ||
                        (!rotation_only && summary.residual_mm[i] > 5 * summary.scatter_mm);
  summary.samples = static_cast<int>(track.time.empty() ? 0 : targets.size());
}

void require_motion(const std::vector<AlignedPose>& poses, const TimeOffsetOptions& options) {
  if (poses.size() < kFewestSamples)
    throw InputError(
        "--camera-poses",
        "only " + std::to_string(poses.size()) + " camera poses fall into gapless stretches of the encoders",
        "record 20 s and more without drop-outs");
  std::vector<Pose> encoder;
  for (const AlignedPose& pose : poses) encoder.push_back(pose.encoder);
  const MotionSpread spread = motion_spread(encoder);
  if (!options.rotation_only) return require_two_axes(spread, "--poses", "hand");
  if (spread.largest_turn_rad < kSmallestTurn)
    throw InputError("--joints",
                     "the joints moved by " + readable(spread.largest_turn_rad * 57.29578, 1) + " degrees at most",
                     "sweep a joint to and fro by 30 degrees and more");
}

void require_correlation(const Lag& lag, const TimeOffsetOptions& options, TimeOffsetSummary& summary) {
  if (lag.correlation < kLeastCorrelation)
    throw InputError("--camera-poses",
                     "the angular speeds do not correlate: " + readable(lag.correlation, 2) + " at best",
                     "check that both streams belong to one body and session, and that it turned to and fro");
  if (std::abs(lag.offset_s - options.around_s) > options.largest_offset_s - 0.05)
    summary.verdict.object("the offset lies at the edge of the search", "widen it by --search");
}

void judge_stretches(double span_s, const TimeOffsetOptions& options, TimeOffsetSummary& summary) {
  if (summary.segments >= kFewestStretches) return;
  const bool one = summary.segments == 1;
  const double fitting = std::floor(10 * span_s / (2 * kFewestStretches)) / 10;
  summary.verdict.object(
      std::to_string(summary.segments) + (one ? " stretch of " : " stretches of ") + readable(options.segment_s, 1) +
          (one ? " s says" : " s say") + " too little about the error of the offset; " +
          std::to_string(kFewestStretches) + " are the least",
      fitting >= kShortestStretch ? "give --segment " + readable(fitting, 1) + ", or record for longer"
                                  : "record for " + readable(2.0 * kFewestStretches, 0) + " s and more");
}

void judge(const std::vector<AlignedPose>& poses, const TimeOffsetOptions& options, TimeOffsetSummary& summary) {
  judge_stretches(poses.back().time_s - poses.front().time_s, options, summary);
  if (!(summary.offset_sigma_s < kLargestSigma))
    summary.verdict.object("the offset is uncertain by " + readable(1e3 * summary.offset_sigma_s, 1) +
                               " ms; half the time between two images is the limit",
                           "record for longer, and turn faster to and fro");
  if (std::abs(summary.offset_s - summary.coarse_offset_s) > kLargestStep)
    summary.verdict.object("the angular speeds agree at " + readable(1e3 * summary.coarse_offset_s, 0) +
                               " ms and the poses at " + readable(1e3 * summary.offset_s, 0) + " ms",
                           "move less regularly, so that one offset alone fits");
  if (3 * summary.outliers > summary.samples)
    summary.verdict.object(
        std::to_string(summary.outliers) + " of " + std::to_string(summary.samples) + " samples lie beyond 5 scatters",
        "check that the camera's poses are those of one target that stands still");
}

}  // namespace

TimeOffsetSummary solve_time_offset(const std::vector<PoseTrack::Sample>& encoder_samples,
                                    const std::vector<PoseTrack::Sample>& camera_samples,
                                    const TimeOffsetOptions& options) {
  if (encoder_samples.size() < 2 || camera_samples.size() < 2)
    throw InputError("streams", "a stream has fewer than two poses", "record 20 s and more");
  const PoseTrack encoder(encoder_samples), camera(camera_samples);
  const Track track(encoder_samples);
  TimeOffsetSummary summary;
  const Lag lag = correlate_speeds(encoder, camera, options);
  summary.coarse_offset_s = lag.offset_s, summary.correlation = lag.correlation;
  summary.lag_s = lag.lags_s, summary.lag_correlation = lag.correlations;
  require_correlation(lag, options, summary);

  StreamHandEye hand_eye;
  for (const bool inverted : {false, true}) {
    const std::vector<AlignedPose> some = aligned_poses(encoder, camera, lag.offset_s, inverted, 3000);
    if (!inverted) require_motion(some, options);
    const StreamHandEye fit = stream_hand_eye(some, options.rotation_only);
    if (!inverted || fit.misfit < 0.7 * hand_eye.misfit) hand_eye = fit, summary.camera_inverted = inverted;
  }
  const std::vector<AlignedPose> poses = aligned_poses(encoder, camera, lag.offset_s, summary.camera_inverted, 20'000);
  State state{lag.offset_s, to_parameters(hand_eye.X), to_parameters(hand_eye.Y)};
  refine(track, poses, options.rotation_only, state);
  ceres::Problem problem;
  build(track, poses, options.rotation_only, state, problem);
  const Eigen::MatrixXd covariance = covariance_of(problem, poses, options.segment_s, state, summary);
  summary.offset_s = state.offset;
  summary.offset_sigma_s = std::sqrt(covariance(0, 0));
  summary.X = to_pose(state.X), summary.Y = to_pose(state.Y);
  summary.X_sigma = covariance.diagonal().segment<6>(1).cwiseMax(0).cwiseSqrt();
  summary.X_sigma.head<3>() *= 2;  // the manifold steps by half angles
  measure_scatter(track, poses, encoder, options.rotation_only, summary);
  judge(poses, options, summary);
  return summary;
}

}  // namespace foresight
