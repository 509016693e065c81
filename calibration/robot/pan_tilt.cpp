#include "calibration/robot/pan_tilt.hpp"

#include <algorithm>

#include "calibration/robot/pan_tilt_problem.hpp"
#include "calibration/robot/pan_tilt_scoring.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

constexpr double kLargestMm = 20, kLargestMrad = 20;  // of poses that were left out: 10 px of a usual lens
constexpr double kChainFits = 0.1;                    // RMS rad: a chain of the wrong order is off by more

PanTiltErrors errors_of(const std::vector<Vector6d>& steps) {
  PanTiltErrors errors;
  std::vector<double> mm, mrad;
  for (const Vector6d& step : steps)
    mrad.push_back(1e3 * step.head<3>().norm()), mm.push_back(1e3 * step.tail<3>().norm());
  errors.mm = root_mean_square(mm), errors.mrad = root_mean_square(mrad);
  errors.median_mm = median(mm), errors.median_mrad = median(mrad);
  return errors;
}

Vector6d off(const PanTiltState& state, const PanTiltSample& sample) {
  return step_between(camera_pose(to_model(state), sample.angles), sample.T_world_camera);
}

// Noise from the residuals, then again with it, until both settle.
void fit_with_noise(const std::vector<PanTiltSample>& samples, PanTiltState& state, int left_out, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> turns, shifts;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (static_cast<int>(i) == left_out) continue;
      const Vector6d step = off(state, samples[i]);
      for (int k = 0; k < 3; ++k) turns.push_back(step[k]), shifts.push_back(step[3 + k]);
    }
    const double redundant = redundancy(kHeadParameters, 6.0 * static_cast<double>(samples.size()));
    const double turn = std::max(1e-9, robust_sigma(turns) / redundant),
                 shift = std::max(1e-9, robust_sigma(shifts) / redundant);
    const bool settled = has_settled(turn, state.sigma_rad, 1e-3) && has_settled(shift, state.sigma_m, 1e-3);
    state.sigma_rad = turn, state.sigma_m = shift;
    if (settled) return;
    fit_pan_tilt(samples, state, left_out);
  }
}

void fit(const std::vector<PanTiltSample>& samples, const PanTiltOptions& options, PanTiltState& state, int left_out) {
  constexpr int kRounds = 12, kRoundsAgain = 3;  // leaving one out starts from the solution
  state.robust = options.robust;
  fit_pan_tilt(samples, state, left_out);
  if (options.robust) fit_with_noise(samples, state, left_out, left_out < 0 ? kRounds : kRoundsAgain);
}

std::vector<PanTiltSample> turned_round(const std::vector<PanTiltSample>& samples, bool inverted) {
  std::vector<PanTiltSample> out = samples;
  if (inverted)
    for (PanTiltSample& sample : out) sample.T_world_camera = sample.T_world_camera.inverse();
  return out;
}

PanTiltState start(std::vector<PanTiltSample>& samples, const PanTiltOptions& options, bool& inverted) {
  std::optional<PanTiltState> best;
  double least = 1e300;
  for (const bool turn_round : {false, true}) {
    if (options.inverted.value_or(turn_round) != turn_round) continue;
    PanTiltState state;
    const double cost = start_pan_tilt(turned_round(samples, turn_round), state);
    if (cost < least) least = cost, best = state, inverted = turn_round;
  }
  samples = turned_round(samples, inverted);
  std::vector<double> turns;
  for (const PanTiltSample& sample : samples) turns.push_back(off(*best, sample).head<3>().norm());
  if (median(turns) > kChainFits)
    throw InputError(
        "--angles",
        "no two-axis head fits: half of the poses turn " + readable(median(turns) * 57.3, 1) + " degrees away",
        "check that angles (rad, pan first) and poses belong together, row by row");
  return *best;
}

void score_left_out(const std::vector<PanTiltSample>& samples, const PanTiltOptions& options, const PanTiltState& state,
                    PanTiltSummary& summary) {
  PanTiltState full = state;
  if (!options.robust) full.sigma_rad = full.sigma_m = 1;
  leave_each_out(
      samples.size(), full, [&](PanTiltState& without, int i) { fit(samples, options, without, i); },
      [&](std::size_t i, const PanTiltState& without) { summary.loo_steps.push_back(off(without, samples[i])); });
  summary.loo = errors_of(summary.loo_steps);
}

PanTiltSummary with_gains_if_better(const std::vector<PanTiltSample>& samples, const PanTiltOptions& options) {
  std::optional<bool> inverted = options.inverted;
  const auto solve = [&](PanTiltOptions choice) {
    choice.inverted = inverted;
    PanTiltSummary summary = solve_pan_tilt(samples, choice);
    inverted = summary.inverted;
    return summary;
  };
  return choose_gains(options, solve, [](const PanTiltSummary& with, const PanTiltSummary& without) {
    return (with.loo.mm / without.loo.mm + with.loo.mrad / without.loo.mrad) / 2;
  });
}

void judge(std::size_t poses, PanTiltSummary& summary) {
  judge_sigmas(summary.names, summary.sigmas, summary.verdict);
  if (summary.loo.mm > kLargestMm || summary.loo.mrad > kLargestMrad)
    summary.verdict.object("poses that were left out are predicted to " + readable(summary.loo.mm, 1) + " mm and " +
                               readable(summary.loo.mrad, 1) + " mrad only",
                           "check that angles (rad, pan first) and poses belong together, row by row");
  if (5 * static_cast<std::size_t>(summary.outliers) > poses)
    summary.verdict.object(std::to_string(summary.outliers) + " of " + std::to_string(poses) + " poses are outliers",
                           "check that angles and poses belong together, and that nothing slipped");
}

}  // namespace

Pose camera_pose(const PanTiltModel& model, const PanTiltAngles& angles) {
  const double pan = model.gain[0] * angles.pan + 0.5 * model.backlash_rad[0] * angles.came[0];
  const double tilt = model.gain[1] * angles.tilt + 0.5 * model.backlash_rad[1] * angles.came[1];
  Pose head = Pose::Identity();
  head.rotate(Eigen::AngleAxisd(pan, Eigen::Vector3d::UnitZ()));
  head.translate(Eigen::Vector3d(model.length_m, 0, 0));
  head.rotate(Eigen::AngleAxisd(model.twist_rad, Eigen::Vector3d::UnitX()));
  head.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitZ()));
  return model.T_world_pan * head * model.T_tilt_camera;
}

void came_from_order(std::vector<PanTiltSample>& samples, double least_rad) {
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const std::array<double, 2> change{samples[i].angles.pan - samples[i - 1].angles.pan,
                                       samples[i].angles.tilt - samples[i - 1].angles.tilt};
    for (std::size_t joint = 0; joint < 2; ++joint)
      samples[i].angles.came[joint] =
          std::abs(change[joint]) < least_rad ? samples[i - 1].angles.came[joint] : (change[joint] > 0 ? 1 : -1);
  }
}

PanTiltSummary solve_pan_tilt(const std::vector<PanTiltSample>& given, const PanTiltOptions& options) {
  if (!options.gains && options.score) return with_gains_if_better(given, options);
  if (given.size() < kFewestHeadViews)
    throw InputError("--poses", counted(given.size(), "pose"), "measure at least 8, better 30, over both joints");
  require_sweeps(angles_of(given));
  std::vector<PanTiltSample> samples = given;
  PanTiltSummary summary;
  PanTiltState state = start(samples, options, summary.inverted);
  choose_joints(angles_of(samples), options.gains.value_or(false), options.backlash, state, summary.notes);
  fit(samples, options, state, -1);
  summary.model = to_model(state);

  std::vector<Vector6d> steps;
  for (const PanTiltSample& sample : samples) steps.push_back(off(state, sample));
  summary.in_sample = errors_of(steps);
  if (!options.robust) {  // the covariance needs a noise; one for both, as the fit assumed
    state.sigma_rad = summary.in_sample.mrad * 1e-3 / std::sqrt(3);
    state.sigma_m = summary.in_sample.mm * 1e-3 / std::sqrt(3);
  }
  summary.sigma_mm = 1e3 * state.sigma_m, summary.sigma_mrad = 1e3 * state.sigma_rad;
  for (const Vector6d& step : steps)
    summary.outliers +=
        step.head<3>().norm() > 5 * state.sigma_rad * 1.54 || step.tail<3>().norm() > 5 * state.sigma_m * 1.54;
  int open = 0;
  const Eigen::MatrixXd covariance = pan_tilt_covariance(samples, state, open);
  if (open > 0)
    throw InputError("--angles", std::to_string(open) + " of the head's parameters stay open",
                     "sweep both joints, each at several angles of the other");
  summary.names = pan_tilt_names(state);
  summary.sigmas = sigmas_of(covariance);
  if (options.score) score_left_out(samples, options, state, summary);
  judge(samples.size(), summary);
  return summary;
}

PanTiltModel read_pan_tilt(const YamlMap& result) {
  PanTiltModel model;
  model.T_world_pan = result.pose("T_world_pan");
  model.T_tilt_camera = result.pose("T_tilt_camera");
  model.length_m = result.number("length_m");
  model.twist_rad = result.number("twist_rad");
  const auto gain = result.numbers("gain", 2), backlash = result.numbers("backlash_rad", 2);
  model.gain = {gain[0], gain[1]}, model.backlash_rad = {backlash[0], backlash[1]};
  return model;
}

}  // namespace foresight
