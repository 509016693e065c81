#include "apps/calibrate/time_command.hpp"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "calibration/robot/joint_chain.hpp"
#include "calibration/robot/robot_results.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct TimeCommandOptions {
  std::optional<std::filesystem::path> poses, joints, urdf;
  std::filesystem::path camera_poses;
  std::string base, flange;
  TimeUnit encoder_unit = TimeUnit::automatic, camera_unit = TimeUnit::automatic;
  TimeOffsetOptions solver;
  CalibrateOutputs outputs;
};

std::vector<PoseTrack::Sample> encoder_poses(TimeCommandOptions& options, std::vector<std::string>& notes) {
  if (options.poses) {
    PoseStream stream = read_pose_stream(*options.poses, options.encoder_unit);
    notes.insert(notes.end(), stream.notes.begin(), stream.notes.end());
    return std::move(stream.samples);
  }
  if (!options.joints)
    throw InputError("--poses", "no motion of the encoders is given", "give --poses FILE, or --joints FILE");
  const JointStream stream = read_joint_stream(*options.joints, options.encoder_unit);
  const std::vector<JointRow>& rows = stream.rows;
  notes.insert(notes.end(), stream.notes.begin(), stream.notes.end());
  if (!options.urdf) {
    options.solver.rotation_only = true;
    return swept_poses(rows, options.joints->string());
  }
  JointChain chain = read_joint_chain(*options.urdf, options.base, options.flange);
  std::vector<PoseTrack::Sample> samples;
  for (const JointRow& row : rows)
    samples.push_back({row.time, flange_pose(chain, row.positions, options.joints->string())});
  return samples;
}

nlohmann::ordered_json numbers_of(const TimeOffsetSummary& s, bool rotation_only) {
  nlohmann::ordered_json out;
  out["offset_s"] = s.offset_s, out["offset_sigma_s"] = s.offset_sigma_s;
  if (!rotation_only) out["scatter_mm"] = s.scatter_mm;
  out["scatter_mrad"] = s.scatter_mrad;
  out["coarse_offset_s"] = s.coarse_offset_s, out["correlation"] = s.correlation;
  out["samples"] = s.samples, out["outliers"] = s.outliers, out["segments"] = s.segments;
  out["camera_poses_are"] = s.camera_inverted ? "camera <- target" : "target <- camera";
  if (!rotation_only) {
    out["T_hand_camera"] = json_of(s.X), out["T_base_target"] = json_of(s.Y);
    out["sigmas"] = sigmas_of(s);
  }
  out["notes"] = s.notes;
  return out;
}

HtmlReport report_of(const TimeOffsetSummary& s, bool rotation_only) {
  HtmlReport report("Clock of the encoders and clock of the camera");
  report.table({"", ""}, {{"t_encoder - t_camera, ms", readable(1e3 * s.offset_s, 2)},
                          {"its sigma, ms", readable(1e3 * s.offset_sigma_s, 2)},
                          {"by correlation alone, ms", readable(1e3 * s.coarse_offset_s, 1)},
                          {"correlation of the angular speeds", readable(s.correlation, 3)},
                          {"median scatter of the target, mm", rotation_only ? "-" : readable(s.scatter_mm, 2)},
                          {"median scatter of the target, mrad", readable(s.scatter_mrad, 2)},
                          {"samples", std::to_string(s.samples)},
                          {"beyond 5 scatters", std::to_string(s.outliers)}});
  report_notes(report, s.notes);
  HtmlReport::Series lag{"correlation", {}, true}, mm{"mm", {}, false}, mrad{"mrad", {}, false};
  for (std::size_t i = 0; i < s.lag_s.size(); ++i) lag.points.emplace_back(s.lag_s[i], s.lag_correlation[i]);
  for (std::size_t i = 0; i < s.residual_time_s.size(); ++i) {
    mm.points.emplace_back(s.residual_time_s[i], std::min(s.residual_mm[i], 10 * s.scatter_mm));
    mrad.points.emplace_back(s.residual_time_s[i], std::min(s.residual_mrad[i], 10 * s.scatter_mrad));
  }
  report.plot("Correlation of the angular speeds", "offset / s", "correlation", {lag});
  if (!rotation_only)
    report.plot("Target's distance from its typical place (cut at 10 medians)", "time / s", "mm", {mm});
  report.plot("Target's turn from its typical orientation (cut at 10 medians)", "time / s", "mrad", {mrad});
  if (!rotation_only) report_sigmas(report, sigmas_of(s));
  return report;
}

int run(TimeCommandOptions& options) {
  std::vector<std::string> notes;
  const std::vector<PoseTrack::Sample> encoder = encoder_poses(options, notes);
  const PoseStream camera = read_pose_stream(options.camera_poses, options.camera_unit);
  notes.insert(notes.end(), camera.notes.begin(), camera.notes.end());
  TimeOffsetSummary summary = solve_time_offset(encoder, camera.samples, options.solver);
  summary.notes.insert(summary.notes.begin(), notes.begin(), notes.end());
  const bool turns = options.solver.rotation_only;
  std::cout << "t_encoder = t_camera " << (summary.offset_s < 0 ? "- " : "+ ")
            << readable(1e3 * std::abs(summary.offset_s), 2) << " ms, sigma "
            << readable(1e3 * summary.offset_sigma_s, 2) << " ms (" << counted(summary.segments, "stretch", "stretches")
            << ")\n"
            << "correlation of angular speeds " << readable(summary.correlation, 3) << " at "
            << readable(1e3 * summary.coarse_offset_s, 1) << " ms\n"
            << "scatter of the target, median: " << (turns ? "" : readable(summary.scatter_mm, 2) + " mm, ")
            << readable(summary.scatter_mrad, 2) << " mrad over " << counted(summary.samples, "sample") << ", "
            << summary.outliers << " beyond 5 times that\n";
  if (!turns)
    std::cout << "T_hand_camera  " << readable_pose(summary.X) << "\nT_base_target  " << readable_pose(summary.Y)
              << "\n";
  print_notes(summary.notes);
  nlohmann::ordered_json numbers = numbers_of(summary, turns);
  return deliver({summary.verdict,
                  {"time", {}, {}, "offset_sigma_s", summary.offset_sigma_s, sigmas_of(summary)},
                  to_yaml(summary),
                  [&] { return report_of(summary, turns); }},
                 numbers, options.outputs);
}

}  // namespace

void add_time(Command& calibrate, std::function<int()>& action) {
  auto options = std::make_shared<TimeCommandOptions>();
  auto* time = calibrate.add_subcommand(
      "time", "Offset of the clocks, t_encoder = t_camera + offset, from motion that both saw");
  auto* poses = time->add_option("--poses", options->poses,
                                 "Encoder stream: rows t x y z qx qy qz qw, base to hand, blanks or commas")
                    ->reads();
  time->add_option("--camera-poses", options->camera_poses, "Camera stream: the same, target to camera or its inverse")
      ->reads()
      ->required();
  time->add_option("--joints", options->joints,
                   "Encoder log instead: rows t q1 q2 ..., rad; one or two joints of a head, or all of --urdf")
      ->reads()
      ->excludes(poses);
  time->add_option("--urdf", options->urdf, "The robot of --joints")->reads();
  time->add_option("--base-link", options->base, "Link that stands still (default: the root)");
  time->add_option("--flange-link", options->flange, "Link that carries the camera (default: the last)");
  const Choices<TimeUnit> units{{"auto", TimeUnit::automatic},
                                {"s", TimeUnit::second},
                                {"ms", TimeUnit::millisecond},
                                {"us", TimeUnit::microsecond},
                                {"ns", TimeUnit::nanosecond}};
  time->add_choice("--time-unit", options->encoder_unit, units, "Of the encoder stream's times: auto, s, ms, us, ns");
  time->add_choice("--camera-time-unit", options->camera_unit, units, "Of the camera stream's times");
  time->add_option("--around", options->solver.around_s, "Rough offset where the search starts, s")
      ->capture_default_str();
  time->add_option("--search", options->solver.largest_offset_s, "Search to both sides, s")
      ->check(from_to(0.1, 3600.0))
      ->capture_default_str();
  time->add_option("--segment", options->solver.segment_s, "Stretches whose errors count as independent, s")
      ->check(from_to(0.1, 60.0))
      ->capture_default_str();
  add_outputs(*time, options->outputs);
  time->footer(
      "Example:\n  foresight calibrate time --poses encoders.csv --camera-poses camera.csv --json time.json --report "
      "time.html");
  time->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace foresight
