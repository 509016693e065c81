#include "apps/calibrate/arm_command.hpp"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calibrate/arm_input.hpp"
#include "apps/calibrate/arm_report.hpp"
#include "apps/calibrate/arm_session.hpp"
#include "apps/calibrate/lens_file.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kWorseThanLeftOut = 2.5;  // of views kept back, of which there are few

struct ArmOptions {
  ArmInput input;
  ArmSessionOptions session;
  std::optional<std::filesystem::path> camera, head;
  std::string mount = "auto", model = "radtan4";
  std::vector<double> head_angles;
  double board_sigma = 0.01;
  CalibrateOutputs outputs;
};

HandEyeOptions solver_options(const ArmOptions& options, std::vector<std::string>& notes) {
  HandEyeOptions out;
  if (options.mount != "auto") out.mount = options.mount == "fixed" ? CameraMount::fixed : CameraMount::moving;
  if (options.camera) {
    const LensInFile lens = read_lens_file(*options.camera, options.input.side == "right" ? Side::right : Side::left);
    if (!lens.note.empty()) notes.push_back(lens.note);
    out.camera = lens.camera;
  }
  out.distortion = parse_distortion(options.model);
  out.board_sigma = options.board_sigma;
  return out;
}

std::optional<Pose> head_of_arm(const ArmOptions& options, const HandEyeSummary& summary) {
  if (!options.head) return std::nullopt;
  if (summary.mount != CameraMount::fixed)
    throw InputError("--head", "the camera moves with the arm",
                     "give --head for a camera on the head that watches the arm");
  const PanTiltModel head = read_pan_tilt(read_result(*options.head, "pan-tilt").result);
  const PanTiltAngles angles{options.head_angles.at(0), options.head_angles.at(1), {}};
  return Pose((head.T_world_pan.inverse() * camera_pose(head, angles)) * summary.X.inverse());
}

std::string board_words(const HandEyeSummary& s) {
  if (s.board_scale_sigma == 0) return "board taken as stated";
  const double off = s.board_scale - 1;
  const std::string sigma = " +/- " + readable(100 * s.board_scale_sigma, 2) + " %";
  if (std::abs(off) < s.board_scale_sigma) return "board as stated" + sigma;
  return "board " + readable(100 * std::abs(off), 2) + sigma + (off < 0 ? " smaller" : " larger") + " than stated";
}

void print(const HandEyeSummary& s) {
  std::cout << "camera is " << to_string(s.mount) << "; " << counted(s.views.size(), "view") << ", "
            << counted(s.rejected_points, "corner") << " rejected\n"
            << name_of_X(s.mount) << "  " << readable_pose(s.X) << "\n"
            << name_of_Y(s.mount) << "  " << readable_pose(s.Y) << "\n"
            << "focal length " << readable(s.camera.lens[0], 2) << " " << readable(s.camera.lens[1], 2) << " px, "
            << board_words(s) << "\n"
            << "noise: corner " << readable(s.sigma_px, 3) << " px, robot " << robot_noise_words(s) << "\n"
            << "in sample " << readable(s.in_sample_px, 3) << " px; left out " << readable(s.loo_px, 3) << " px, "
            << readable(s.loo_mm, 3) << " mm\n";
}

/// Takes the views of a guided session, and makes them what is solved. False: it was stopped.
bool guide(ArmOptions& options) {
  ArmInput& input = options.input;
  if (!input.rig) throw InputError("--guided", "it needs the robot", "give --rig RIG");
  if (input.images || input.run || input.corners || input.poses || input.joints)
    throw InputError("--guided", "it takes its own views",
                     "leave --images, --run, --corners, --poses and --joints out");
  ArmSessionOptions& session = options.session;
  session.rig = *input.rig, session.board = input.board, session.side = input.side;
  session.base = input.names.base, session.flange = input.names.flange;
  if (session.views.empty()) {
    if (!options.outputs.out)
      throw InputError("--views", "there is no folder for the views", "give --out FILE, or --views DIR");
    session.views = options.outputs.out->parent_path() / (options.outputs.out->stem().string() + "-views");
  }
  if (!run_arm_session(session)) return false;
  input.images = session.views, input.joints = session.views / "joints.csv";
  std::cout << "views and joints are in " << session.views.string() << "\n";
  return true;
}

/// On views that the solver has not seen.
HandEyeScore verify_kept(const ArmViews& unseen, const ArmViews& solved, HandEyeSummary& summary) {
  std::map<std::string, double> offsets;
  for (std::size_t j = 0; j < std::min(summary.joint_offsets.size(), solved.names.joints.size()); ++j)
    offsets[solved.names.joints[j]] = summary.joint_offsets[j];
  const HandEyeScore score = score_hand_eye({summary.mount, summary.camera, summary.X, summary.Y, summary.board_scale},
                                            with_poses(unseen, offsets));
  std::cout << "kept back " << counted(score.views, "view") << ": " << readable(score.px, 3) << " px, "
            << readable(score.mm, 3) << " mm\n";
  if (score.px > kWorseThanLeftOut * summary.loo_px)
    summary.verdict.object("views that were kept back are predicted to " + readable(score.px, 2) +
                               " px, and those that were left out one by one to " + readable(summary.loo_px, 2),
                           "look at the views for one in which something moved, and take more");
  return score;
}

int run(ArmOptions& options) {
  if (options.session.guided && !guide(options)) return kStopped;
  ArmViews views = read_arm_views(options.input);
  const std::optional<ArmViews> unseen = options.session.guided ? std::optional(keep_back(views)) : std::nullopt;
  HandEyeOptions solver = solver_options(options, views.notes);
  if (!solver.camera) solver.camera = lens_of_run(options.input);
  HandEyeSummary summary;
  if (options.session.guided) {
    // A session's views are too few to tell joint offsets from all else; more of them, given by --joints, do.
    summary = solve_hand_eye(with_poses(views, {}), solver);
  } else if (views.chain) {
    JointChain chain = *views.chain;
    summary = solve_with_joints(chain, views.rows, views.data, solver);
  } else {
    summary = solve_hand_eye(views.data, solver);
  }
  summary.notes.insert(summary.notes.begin(), views.notes.begin(), views.notes.end());
  const std::optional<Pose> T_head_base = head_of_arm(options, summary);
  print(summary);
  const std::optional<HandEyeScore> kept = unseen ? std::optional(verify_kept(*unseen, views, summary)) : std::nullopt;
  if (T_head_base) std::cout << "T_head_base  " << readable_pose(*T_head_base) << "\n";
  print_notes(summary.notes);
  nlohmann::ordered_json numbers = arm_numbers(summary, views.names, T_head_base);
  if (kept) numbers["kept_back"] = {{"views", kept->views}, {"px", kept->px}, {"mm", kept->mm}};
  ResultHeader header{"arm", {}, {}, "loo_px", summary.loo_px, sigmas_of(summary, views.names)};
  header.views = prints_of(views.data.corners);
  return deliver({summary.verdict, header, to_yaml(summary, views.names, T_head_base),
                  [&] { return arm_report(summary, views, kept); }},
                 numbers, options.outputs);
}

}  // namespace

void add_arm(Command& calibrate, std::function<int()>& action) {
  auto options = std::make_shared<ArmOptions>();
  auto* arm = calibrate.add_subcommand("arm", "Hand-eye of a camera on an arm, or of an arm before a camera");
  add_arm_input(*arm, options->input);
  arm->add_option(
         "--camera", options->camera,
         "Known lens: result of stereo (that of --side), intrinsics or arm, or camera_info; else that of --run,\n"
         "or it is estimated")
      ->reads();
  arm->add_option("--model", options->model, "Lens model that is estimated")->capture_default_str();
  arm->add_option("--camera-link", options->input.names.camera,
                  "Name of the camera's link in a URDF (default: camera)");
  arm->add_option("--camera-mount", options->mount, "Camera fixed beside the arm, or moving with it")
      ->check(one_of({"auto", "fixed", "moving"}))
      ->capture_default_str();
  arm->add_option("--board-sigma", options->board_sigma, "Doubt about the board's stated size, relative; 0: exact")
      ->check(from_to(0.0, 0.2))
      ->capture_default_str();
  auto* head = arm->add_option("--head", options->head,
                               "Result of kind pan-tilt of the head that carries the camera: arm to head")
                   ->reads();
  head->needs(
      arm->add_option("--head-angles", options->head_angles, "Pan and tilt during the session, rad")->expected(2));
  add_arm_session(*arm, options->session);
  add_outputs(*arm, options->outputs);
  arm->footer(
      "Examples:\n"
      "  foresight calibrate arm --images views --poses poses.txt --board charuco:5x7:0.036:0.018 --report arm.html\n"
      "  foresight calibrate arm --run session --rig lab.yaml --board chessboard:9x6:0.025 --out arm.yaml\n"
      "  foresight calibrate arm --guided --rig lab.yaml --board chessboard:9x6:0.025 --out arm.yaml");
  arm->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace foresight
