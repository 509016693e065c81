#include "apps/calibrate/verify_command.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calibrate/arm_verify.hpp"
#include "apps/calibrate/camera_input.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/pan_tilt_verify.hpp"
#include "calibration/camera/camera_result.hpp"
#include "calibration/camera/held_out.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct VerifyOptions {
  std::filesystem::path result;
  CornerInput input;
  std::optional<double> joint_px, cross_px, epipolar_px;
  PanTiltVerify head;
  ArmVerify arm;
  std::optional<std::filesystem::path> json;
  bool flat = false;
};

struct KnownRig {
  CameraRig rig;
  std::optional<KnownBoard> board;
  double score_px = 0;
  ViewPrints views;  ///< that it was solved from
};

KnownRig read_rig(const std::filesystem::path& file) {
  const std::string kind = YamlMap::load(file).text("kind");
  if (kind != "intrinsics" && kind != "stereo")
    throw InputError(file.string(), "it holds a result of kind " + in_quotes(kind),
                     "give one of `foresight calibrate stereo`, `intrinsics`, `arm` or `pan-tilt`");
  const ResultFile result = read_result(file, kind);
  KnownRig known;
  known.score_px = result.header.score;
  known.views = result.header.views;
  known.board = read_known_board(result.result);
  known.rig = {read_calibrated_cameras(result.result), {}};
  return known;
}

void require_same_size(const CameraRig& rig, RigViews& views, const std::filesystem::path& file) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const CameraModel& model = rig.cameras[c];
    if (views.width[c] != 0 && (views.width[c] != model.width || views.height[c] != model.height))
      throw InputError(file.string(),
                       "it was calibrated with images of " + std::to_string(model.width) + "x" +
                           std::to_string(model.height) + ", not " + std::to_string(views.width[c]) + "x" +
                           std::to_string(views.height[c]),
                       "verify with images of the same size");
  }
}

// The session's board is as bent now as it was then; another one is taken as flat.
void bend_board(const VerifyOptions& options, const RigViews& views, KnownRig& known) {
  if (options.flat || !known.board) return;
  if (known.board->is_laid_out_as(views.p_board)) {
    known.rig.warp = known.board->warp;
    std::printf("board as bent as the result says: %s along x, %s along y (--flat: not)\n",
                readable(1000 * known.rig.warp.x_m, 3).c_str(), readable(1000 * known.rig.warp.y_m, 3, " mm").c_str());
  } else {
    std::printf("another board than that of the result: taken as flat\n");
  }
}

/// Leaves out the views that the result was solved from, by what they show: its error on them says nothing. Where no
/// other is there, they stay, and count against it.
void keep_unseen(const KnownRig& known, RigViews& views, nlohmann::ordered_json& json, Verdict& verdict) {
  std::vector<std::size_t> unseen;
  for (std::size_t v = 0; v < views.views.size(); ++v)
    if (!knows(known.views, print_of(views.views[v]))) unseen.push_back(v);
  const std::size_t seen = views.views.size() - unseen.size();
  json["views_of_the_calibration"] = seen;
  if (seen == 0) return;
  if (unseen.empty()) {
    verdict.object("all views are among those that the result was solved from, and say nothing about others",
                   "take new pictures, and verify with these");
    return;
  }
  tell_seen(seen, views.views.size());
  views = subset(views, unseen);
}

int verify(const VerifyOptions& options) {
  KnownRig known = read_rig(options.result);
  const bool pair = known.rig.cameras.size() == 2;
  CameraViewsInput input = read_camera_input(options.input, pair);
  require_same_size(known.rig, input.train, options.result);
  bend_board(options, input.train, known);
  Verdict verdict;
  nlohmann::ordered_json json;
  keep_unseen(known, input.train, json, verdict);
  const HeldOutScore score = score_views(known.rig, input.train);
  if (score.views == 0)
    throw InputError("corners", "the board could be placed in no view",
                     "check that --board names the board that was shown");
  json["views"] = score.views;
  json["board_warp_m"] = {known.rig.warp.x_m, known.rig.warp.y_m};
  const auto row = [&](const std::string& name, double value, double limit, const std::string& cure) {
    const bool good = value <= limit;
    std::printf("%-9s %s  (limit %s)  %s\n", name.c_str(), readable(value, 4, " px").c_str(),
                readable(limit, 4).c_str(), good ? "pass" : "FAIL");
    json[name + "_px"] = value;
    json[name + "_limit_px"] = limit;
    if (!good) verdict.object("the " + name + " error is above its limit", cure);
  };
  const std::string lens = "check --board and the focus; where both are as they were, calibrate the lenses again",
                    place =
                        "the cameras may have moved against each other, or their pictures are not of one instant: "
                        "calibrate the pair again";
  row("joint", score.joint_px, options.joint_px.value_or(kWorseThanScore * known.score_px), lens);
  if (pair) {
    // Predicted from one camera alone, errors are larger by about the square root of two.
    row("cross", score.cross_px, options.cross_px.value_or(kWorseThanScore * M_SQRT2 * known.score_px), place);
    row("epipolar", score.epipolar_px, options.epipolar_px.value_or(kWorseThanScore * known.score_px), place);
  }
  json["joint_inlier_px"] = score.joint_inlier_px;
  if (pair) json["cross_inlier_px"] = score.cross_inlier_px, json["epipolar_inlier_px"] = score.epipolar_inlier_px;
  json["rejected_points"] = score.rejected_points;
  if (score.rejected_points > 0)
    std::printf("joint without %s: %s\n", counted(score.rejected_points, "outlier").c_str(),
                readable(score.joint_inlier_px, 4, " px").c_str());
  return tell_verified(verdict, static_cast<std::size_t>(score.views), json, options.json);
}

int verify_any(const VerifyOptions& options) {
  const std::string kind = YamlMap::load(options.result).text("kind");
  if (kind == "arm") {
    ArmVerify arm = options.arm;
    arm.result = options.result, arm.json = options.json;
    arm.input.images = options.input.images, arm.input.corners = options.input.corners;
    arm.input.board = options.input.board;
    arm.input.run = options.head.input.run, arm.input.joints = options.head.input.joints,
    arm.input.time = options.head.time;
    return verify_arm(arm);
  }
  if (kind != "pan-tilt") return verify(options);
  PanTiltVerify head = options.head;
  head.result = options.result, head.json = options.json;
  head.input.images = options.input.images ? options.input.images : options.input.left;
  head.input.right = options.input.right;
  return verify_head(head);
}

void add_arm_options(Command& command, ArmVerify& arm) {
  auto* group = command.add_option_group("Of an arm (result of arm), beside --run, --joints and --time");
  group->add_option("--poses", arm.input.poses, "Robot poses, base to flange, of --images or --corners")->reads();
  group->add_option("--pose-unit", arm.input.unit, "Of the positions")
      ->check(one_of({"auto", "m", "mm"}))
      ->capture_default_str();
  group->add_flag("--invert-poses", arm.input.invert, "The poses are written from flange to base");
  group->add_option("--urdf", arm.input.urdf, "The arm, for --joints or --run")->reads();
  group->add_option("--rig", arm.input.rig, "The arm of this rig")->reads();
  group->add_option("--side", arm.input.side, "Of the recording: left or right pictures")
      ->check(one_of({"left", "right"}))
      ->capture_default_str();
  group->add_option("--base-link", arm.input.names.base, "Link that stands still (default: the root)");
  group->add_option("--flange-link", arm.input.names.flange, "Link that carries camera or board (default: the last)");
  group->add_option("--robot-px", arm.px, "Limit, RMS (default: 1.5 times the result's score)");
}

void add_head_options(Command& command, PanTiltVerify& head) {
  PanTiltTagInput& input = head.input;
  auto* group = command.add_option_group("Of a head (result of pan-tilt)");
  group->add_option("--tags", input.tags, "Map of tags that stand still: rows id corner x y z, world, m")->reads();
  group->add_option("--run", input.run, "A recorded run and its joints, instead of images")->reads();
  group->add_option("--joints", input.joints, "The joints of the run (default: RUN-joints.csv)")->reads();
  group->add_option("--joint-names", input.joint_names, "Of pan and tilt in it")->expected(2)->capture_default_str();
  group->add_option("--time", head.time, "Result of `calibrate time`")->reads();
  group->add_option("--angles", input.angles, "Of each image: rows [name] pan tilt [pan_way tilt_way]")->reads();
  group->add_option("--camera", input.camera, "Lens: result of stereo, intrinsics or arm, or camera_info")->reads();
  group->add_option("--camera-right", input.camera_right, "The right camera's (camera_info with T_left_right)")
      ->reads();
  group
      ->add_option("--photometric", input.photometric,
                   "Result of `calibrate photometric`: corners of tags are found in the light")
      ->reads();
  group->add_option("--family", input.family, "Of the tags")->capture_default_str();
  group->add_option("--encoders-px", head.encoders_px, "Limit by encoders alone, RMS")->capture_default_str();
  group->add_option("--tags-px", head.tags_px, "Limit of tags that others have corrected, RMS")->capture_default_str();
}

}  // namespace

void add_verify(Command& calibrate, std::function<int()>& action) {
  auto* command = calibrate.add_subcommand("verify", "Errors of a result on views that no solver has seen");
  auto options = std::make_shared<VerifyOptions>();
  command->add_option("--result", options->result, "Result file of `stereo`, `intrinsics`, `pan-tilt` or `arm`")
      ->reads()
      ->required();
  add_camera_input(*command, options->input, true);
  command->add_option("--images", options->input.images, "Of one camera: folder of images, or a pattern")->reads();
  add_head_options(*command, options->head);
  add_arm_options(*command, options->arm);
  command->add_option("--joint", options->joint_px, "Limit in px; default: 1.5 times the result's own score");
  command->add_option("--cross", options->cross_px, "Limit in px; default: 2.1 times the result's own score");
  command->add_option("--epipolar", options->epipolar_px, "Limit in px; default: 1.5 times the result's own score");
  command->add_flag("--flat", options->flat, "Take the board as flat, also where the result knows how it is bent");
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Examples: foresight calibrate verify --result stereo.yaml --corners new.vnl "
      "--board chessboard:9x6:0.025\n"
      "          foresight calibrate verify --result head.yaml --run sweep2 --tags tags.txt\n"
      "          foresight calibrate verify --result arm.yaml --run second --rig lab.yaml --board "
      "chessboard:9x6:0.025\n"
      "Exit code: 1 where a limit is exceeded, or where all views were among those of the calibration.");
  command->callback([options, &action] { action = [options] { return verify_any(*options); }; });
}

}  // namespace foresight
