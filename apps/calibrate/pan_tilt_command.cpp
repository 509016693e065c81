#include "apps/calibrate/pan_tilt_command.hpp"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calibrate/head_drawing.hpp"
#include "apps/calibrate/lens_file.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/pan_tilt_input.hpp"
#include "apps/calibrate/pan_tilt_tag_command.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "calibration/robot/robot_results.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct PanTiltCommandOptions {
  PanTiltInput input;
  PanTiltTagCommand tags;
  std::string poses_are = "auto", gains = "auto";
  PanTiltOptions solver;
  CalibrateOutputs outputs;
};

nlohmann::ordered_json errors_json(const PanTiltErrors& errors) {
  return {
      {"mm", errors.mm}, {"mrad", errors.mrad}, {"median_mm", errors.median_mm}, {"median_mrad", errors.median_mrad}};
}

nlohmann::ordered_json numbers_of(const PanTiltSummary& s, const PanTiltSummary& plain, std::size_t poses) {
  nlohmann::ordered_json out;
  out["loo_mm"] = s.loo.mm, out["loo_mrad"] = s.loo.mrad;
  out["plain_loo_mm"] = plain.loo.mm, out["plain_loo_mrad"] = plain.loo.mrad;
  out["poses"] = poses, out["outliers"] = s.outliers;
  out["in_sample"] = errors_json(s.in_sample), out["left_out"] = errors_json(s.loo);
  out["plain_in_sample"] = errors_json(plain.in_sample), out["plain_left_out"] = errors_json(plain.loo);
  out["noise_mm"] = s.sigma_mm, out["noise_mrad"] = s.sigma_mrad;
  out["poses_are"] = s.inverted ? "camera-world" : "world-camera";
  const PanTiltModel& m = s.model;
  out["model"] = {
      {"T_world_pan", json_of(m.T_world_pan)},     {"length_m", m.length_m}, {"twist_rad", m.twist_rad},
      {"T_tilt_camera", json_of(m.T_tilt_camera)}, {"gain", m.gain},         {"backlash_rad", m.backlash_rad}};
  out["sigmas"] = sigmas_of(s);
  out["notes"] = s.notes;
  return out;
}

std::vector<std::string> error_row(const std::string& name, const PanTiltErrors& e) {
  return {name, readable(e.mm, 3), readable(e.mrad, 3), readable(e.median_mm, 3), readable(e.median_mrad, 3)};
}

HtmlReport report_of(const PanTiltSummary& s, const PanTiltSummary& plain, const std::vector<PanTiltSample>& samples) {
  HtmlReport report("Pan-tilt calibration");
  report.table({"error of the camera's pose", "RMS / mm", "RMS / mrad", "median / mm", "median / mrad"},
               {error_row("this fit, left out", s.loo), error_row("this fit, in sample", s.in_sample),
                error_row("plain least squares, left out", plain.loo),
                error_row("plain least squares, in sample", plain.in_sample)});
  report_notes(report, s.notes);
  report_model(report, s.model);
  DrawnHead head{s.model, {}};
  for (const PanTiltSample& sample : samples) head.angles.push_back(sample.angles);
  report.drawing("Where everything stands", head_svg(head));
  HtmlReport::Series pan{"mm", {}, false}, pan_turn{"mrad", {}, false}, tilt{"mm", {}, false},
      tilt_turn{"mrad", {}, false};
  for (std::size_t i = 0; i < s.loo_steps.size(); ++i) {
    const double mm = 1e3 * s.loo_steps[i].tail<3>().norm(), mrad = 1e3 * s.loo_steps[i].head<3>().norm();
    pan.points.emplace_back(samples[i].angles.pan, mm), pan_turn.points.emplace_back(samples[i].angles.pan, mrad);
    tilt.points.emplace_back(samples[i].angles.tilt, mm), tilt_turn.points.emplace_back(samples[i].angles.tilt, mrad);
  }
  report.plot("Error of each pose when it is left out, over pan", "pan / rad", "mm or mrad", {pan, pan_turn});
  report.plot("Error of each pose when it is left out, over tilt", "tilt / rad", "mm or mrad", {tilt, tilt_turn});
  report_sigmas(report, sigmas_of(s));
  return report;
}

void print(const PanTiltSummary& s, const PanTiltSummary& plain) {
  const auto line = [](const std::string& name, const PanTiltErrors& e) {
    std::cout << name << readable(e.mm, 3) << " mm, " << readable(e.mrad, 3) << " mrad RMS; median "
              << readable(e.median_mm, 3) << " mm, " << readable(e.median_mrad, 3) << " mrad\n";
  };
  line("this fit, left out                ", s.loo);
  line("this fit, in sample               ", s.in_sample);
  line("plain least squares, left out     ", plain.loo);
  line("plain least squares, in sample    ", plain.in_sample);
  std::cout << "axes " << readable(1e3 * s.model.length_m, 2) << " mm apart, "
            << readable(s.model.twist_rad * 57.29577951, 3) << " degrees between them\n"
            << "backlash pan " << readable(1e3 * s.model.backlash_rad[0], 3) << " mrad, tilt "
            << readable(1e3 * s.model.backlash_rad[1], 3) << " mrad; poses beyond 5 sigma " << s.outliers << "\n";
}

/// A tag map decides: then the corners are solved for, not the poses of views.
int run_with_tags(PanTiltCommandOptions& options) {
  if (options.input.poses || options.input.corners || !options.input.board.empty())
    throw InputError("--tags, --run", "stand beside --poses, --corners or --board", "choose one");
  PanTiltTagCommand& command = options.tags;
  command.input.images = options.input.images, command.input.angles = options.input.angles;
  command.input.camera = options.input.camera, command.input.in_order = options.input.in_order;
  if (options.gains != "auto") command.solver.gains = options.gains == "on";
  command.outputs = options.outputs;
  return calibrate_from_tags(command);
}

int run(PanTiltCommandOptions& options) {
  if (options.tags.input.tags || options.tags.input.run) return run_with_tags(options);
  std::vector<std::string> notes;
  const std::vector<PanTiltSample> samples = read_pan_tilt_samples(options.input, notes);
  if (options.poses_are != "auto") options.solver.inverted = options.poses_are == "camera-world";
  if (options.gains != "auto") options.solver.gains = options.gains == "on";
  PanTiltSummary summary = solve_pan_tilt(samples, options.solver);
  PanTiltOptions plain_options = options.solver;
  plain_options.robust = plain_options.backlash = false;
  plain_options.gains = false;
  plain_options.inverted = summary.inverted;
  const PanTiltSummary plain = solve_pan_tilt(samples, plain_options);
  summary.notes.insert(summary.notes.begin(), notes.begin(), notes.end());
  print(summary, plain);
  print_notes(summary.notes);
  nlohmann::ordered_json numbers = numbers_of(summary, plain, samples.size());
  return deliver({summary.verdict,
                  {"pan-tilt", {}, {}, "loo_mrad", summary.loo.mrad, sigmas_of(summary)},
                  to_yaml(summary.model),
                  [&] { return report_of(summary, plain, samples); }},
                 numbers, options.outputs);
}

}  // namespace

void add_pan_tilt(Command& calibrate, std::function<int()>& action) {
  auto options = std::make_shared<PanTiltCommandOptions>();
  PanTiltInput& input = options->input;
  auto* head = calibrate.add_subcommand(
      "pan-tilt", "Axes, zero angles and backlash of a two-axis head, from poses or views at known angles");
  head->add_option(
          "--poses", input.poses,
          "Camera poses in the world: 4x4 rows or x y z qx qy qz qw; or .yaml with angles: NAME: {pose, target_joints}")
      ->reads();
  head->add_option("--angles", input.angles,
                   "Rows [name] pan tilt [pan_way tilt_way], rad; ways +1 or -1: from below or above")
      ->reads();
  head->add_option("--images", input.images,
                   "Views of a tag map (--tags) or a board that stands still, instead of poses")
      ->reads();
  head->add_option("--corners", input.corners, "Found corners instead of images")->reads();
  head->add_option("--board", input.board, "The board, such as apriltag:6x6:0.055");
  head->add_option("--camera", input.camera,
                   std::string("The lens, for views: ") + kLensFile + "; with --tags both of stereo")
      ->reads();
  add_tag_options(*head, options->tags.input);
  head->add_option("--time", options->tags.time, "Result of `calibrate time` for --run; else a moving head tells it")
      ->reads();
  head->add_option("--poses-are", options->poses_are, "camera to world, or its inverse")
      ->check(one_of({"auto", "world-camera", "camera-world"}))
      ->capture_default_str();
  head->add_flag("--in-order", input.in_order, "The rows are in the order in which they were taken: gives the ways");
  head->add_option("--gains", options->gains,
                   "Estimate what a reported angle is worth; auto: where the left-out error falls")
      ->check(one_of({"auto", "on", "off"}))
      ->capture_default_str();
  add_outputs(*head, options->outputs);
  head->footer(
      "Examples:\n"
      "  foresight calibrate pan-tilt --images left --right right --angles angles.txt --tags tags.txt --camera "
      "stereo.yaml --out head.yaml\n"
      "  foresight calibrate pan-tilt --run sweep --tags tags.txt --out head.yaml\n"
      "  foresight calibrate pan-tilt --images head --board apriltag:6x6:0.055 --camera left.yaml --angles angles.txt");
  head->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace foresight
