#include "apps/calibrate/arm_command.hpp"

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>

#include "apps/calibrate/arm_report.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "calibration/robot/joint_chain.hpp"
#include "calibration/robot/robot_poses.hpp"
#include "calibration/target/corner_files.hpp"
#include "calibration/target/image_input.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct ArmOptions {
  std::optional<std::filesystem::path> images, corners, poses, joints, urdf, camera, head;
  std::string board, mount = "auto", unit = "auto", model = "radtan4";
  ArmNames names{"", "", "camera", {}};
  std::vector<double> head_angles;
  double board_sigma = 0.01;
  bool invert = false;
  CalibrateOutputs outputs;
};

struct Inputs {
  HandEyeData data;
  std::vector<std::string> images;  // all of them, also those without the board
  std::vector<std::string> notes;
};

Inputs read_views(const ArmOptions& options) {
  std::optional<Board> board;
  if (!options.board.empty()) board = parse_board(options.board);
  Inputs in;
  if (options.images) {
    if (!board) throw InputError("--board", "is missing", "name the board in the images, such as chessboard:9x6:0.025");
    FoundCorners found = find_in_folder(*options.images, *board);
    for (const auto& image : list_images(*options.images)) in.images.push_back(image.stem().string());
    for (const DroppedView& dropped : found.dropped)
      in.notes.push_back("view " + dropped.name + " is left out: " + dropped.reason);
    in.data.corners = std::move(found.corners);
  } else if (options.corners) {
    in.data.corners = read_corners(*options.corners, board);
    for (const BoardView& view : in.data.corners.views) in.images.push_back(view.name);
  } else {
    throw InputError("--images", "no views are given", "give --images DIR or --corners PATH");
  }
  if (board && (board->kind == BoardKind::chessboard || board->kind == BoardKind::circles))
    in.data.cols = board->cols, in.data.rows = board->rows;
  return in;
}

std::vector<std::string> view_names(const Inputs& in) {
  std::vector<std::string> names;
  for (const BoardView& view : in.data.corners.views) names.push_back(view.name);
  return names;
}

void read_poses(const ArmOptions& options, Inputs& in) {
  const PoseUnit unit = options.unit == "auto" ? PoseUnit::automatic
                        : options.unit == "mm" ? PoseUnit::millimetre
                                               : PoseUnit::metre;
  const RobotPoses read = read_robot_poses(*options.poses, unit);
  in.notes.insert(in.notes.end(), read.notes.begin(), read.notes.end());
  const MatchedPoses matched = match_poses(read.poses, in.images, view_names(in));
  in.notes.push_back("robot poses were matched to the images " + matched.how);
  for (const Pose& pose : matched.poses) in.data.poses.push_back({options.invert ? pose.inverse() : pose, {}});
}

struct JointRow {
  std::string name;  // of the image, or empty
  std::vector<double> positions;
};

// A first field more than the joints is a name.
std::vector<JointRow> read_joint_rows(const std::filesystem::path& file, std::size_t joints) {
  std::vector<JointRow> rows;
  for (const FieldRow& row : read_field_rows(file)) {
    JointRow out;
    if (row.fields.size() == joints + 1) out.name = std::filesystem::path(row.fields[0]).stem().string();
    for (std::size_t i = row.fields.size() > joints ? 1 : 0; i < row.fields.size(); ++i) {
      const auto value = parse_number(row.fields[i]);
      if (!value)
        throw InputError(at_line(file, row.line), in_quotes(row.fields[i]) + " is not a number",
                         "write joint positions in rad");
      out.positions.push_back(*value);
    }
    rows.push_back(std::move(out));
  }
  return rows;
}

// Joint positions of each view: by the rows' names where these are the images', else by order of the images.
std::vector<std::vector<double>> read_joints(const std::filesystem::path& file, std::size_t joints, Inputs& in) {
  const std::vector<JointRow> rows = read_joint_rows(file, joints);
  std::map<std::string, std::size_t> by_name;
  for (std::size_t i = 0; i < rows.size(); ++i) by_name.emplace(rows[i].name, i);
  const std::vector<std::string> views = view_names(in);
  const bool named = by_name.size() == rows.size() && std::all_of(views.begin(), views.end(), [&](const auto& view) {
                       return by_name.contains(std::filesystem::path(view).stem().string());
                     });
  if (!named && rows.size() != in.images.size())
    throw InputError("--joints",
                     std::to_string(rows.size()) + " rows for " + std::to_string(in.images.size()) + " images",
                     "give one row an image, or name the rows as the images");
  in.notes.push_back("joint positions were matched to the images by " + std::string(named ? "name" : "order"));
  std::vector<std::vector<double>> out;
  for (const std::string& view : views) {
    const auto place =
        static_cast<std::size_t>(std::find(in.images.begin(), in.images.end(), view) - in.images.begin());
    out.push_back(rows[named ? by_name.at(std::filesystem::path(view).stem().string()) : place].positions);
  }
  return out;
}

HandEyeOptions solver_options(const ArmOptions& options) {
  HandEyeOptions out;
  if (options.mount != "auto") out.mount = options.mount == "fixed" ? CameraMount::fixed : CameraMount::moving;
  if (options.camera) out.camera = read_camera_file(*options.camera);
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

void print(const HandEyeSummary& s) {
  std::cout << "camera is " << to_string(s.mount) << "; views " << s.views.size() << ", corners rejected "
            << s.rejected_points << "\n"
            << name_of_X(s.mount) << "  " << readable_pose(s.X) << "\n"
            << name_of_Y(s.mount) << "  " << readable_pose(s.Y) << "\n"
            << "focal length " << readable(s.camera.lens[0], 2) << " " << readable(s.camera.lens[1], 2) << " px, board "
            << readable(100 * (s.board_scale - 1), 2) << " +/- " << readable(100 * s.board_scale_sigma, 2)
            << " % larger than stated\n"
            << "noise: corner " << readable(s.sigma_px, 3) << " px, robot " << readable(1e3 * s.sigma_robot_m, 2)
            << " mm and " << readable(1e3 * s.sigma_robot_rad, 2) << " mrad\n"
            << "in sample " << readable(s.in_sample_px, 3) << " px; left out " << readable(s.loo_px, 3) << " px, "
            << readable(s.loo_mm, 3) << " mm\n";
}

int run(ArmOptions& options) {
  Inputs in = read_views(options);
  HandEyeSummary summary;
  if (options.urdf) {
    if (!options.joints)
      throw InputError("--urdf", "no joint positions are given", "give --joints FILE, one row an image");
    JointChain chain = read_joint_chain(*options.urdf, options.names.base, options.names.flange);
    for (const int joint : chain.joints)
      options.names.joints.push_back(chain.robot.joints[static_cast<std::size_t>(joint)].name);
    options.names.base = chain.robot.links[static_cast<std::size_t>(chain.base)].name;
    options.names.flange = chain.robot.links[static_cast<std::size_t>(chain.flange)].name;
    const auto rows = read_joints(*options.joints, chain.joints.size(), in);
    summary = solve_with_joints(chain, rows, in.data, solver_options(options));
  } else {
    if (!options.poses)
      throw InputError("--poses", "no robot poses are given", "give --poses FILE or DIR, or --urdf and --joints");
    if (options.names.base.empty()) options.names.base = "base";
    if (options.names.flange.empty()) options.names.flange = "flange";
    read_poses(options, in);
    summary = solve_hand_eye(in.data, solver_options(options));
  }
  summary.notes.insert(summary.notes.begin(), in.notes.begin(), in.notes.end());
  const std::optional<Pose> T_head_base = head_of_arm(options, summary);
  print(summary);
  if (T_head_base) std::cout << "T_head_base  " << readable_pose(*T_head_base) << "\n";
  print_notes(summary.notes);
  write_json(options.outputs.json, arm_numbers(summary, options.names, T_head_base));
  if (options.outputs.report) arm_report(summary, options.names).write(*options.outputs.report);
  if (options.outputs.out) {
    const ResultHeader header{"arm", utc_now(), {}, "loo_px", summary.loo_px, sigmas_of(summary, options.names)};
    write_result(*options.outputs.out, header, to_yaml(summary, options.names, T_head_base), options.outputs.force);
  }
  return 0;
}

}  // namespace

void add_arm(Command& calibrate, std::function<int()>& action) {
  auto options = std::make_shared<ArmOptions>();
  auto* arm = calibrate.add_subcommand("arm", "Hand-eye of a camera on an arm, or of an arm before a camera");
  arm->add_option("--images", options->images, "Folder of images")->reads();
  arm->add_option("--corners", options->corners, "Found corners instead: .vnl file, or folder of .csv")->reads();
  arm->add_option("--board", options->board,
                  "Board, such as chessboard:9x6:0.025 or charuco:5x7:0.036:0.018:DICT_6X6_250");
  arm->add_option("--poses", options->poses,
                  "Robot poses, base to flange: 4x4 rows, x y z qx qy qz qw, or a folder with one file each")
      ->reads();
  arm->add_option("--pose-unit", options->unit, "Of the positions")
      ->check(one_of({"auto", "m", "mm"}))
      ->capture_default_str();
  arm->add_flag("--invert-poses", options->invert, "The poses are written from flange to base");
  arm->add_option("--joints", options->joints,
                  "Joint positions instead, rad, rows [name] q1 q2 ..., for --urdf; also gives their offsets")
      ->reads();
  arm->add_option("--urdf", options->urdf, "The arm")->reads();
  arm->add_option("--base-link", options->names.base, "Link that stands still (default: the root)");
  arm->add_option("--flange-link", options->names.flange, "Link that carries camera or board (default: the last)");
  arm->add_option("--camera", options->camera,
                  "Known lens: result of kind intrinsics, or camera_info; else it is estimated")
      ->reads();
  arm->add_option("--model", options->model, "Lens model that is estimated")->capture_default_str();
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
  add_outputs(*arm, options->outputs);
  arm->footer(
      "Example:\n  foresight calibrate arm --images views --poses poses.txt --board charuco:5x7:0.036:0.018 "
      "--json arm.json --report arm.html");
  arm->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace foresight
