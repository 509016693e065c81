#include "apps/record_command.hpp"

#include <cstdio>
#include <memory>

#include "apps/line_recording.hpp"
#include "apps/link_command.hpp"
#include "apps/recording_outputs.hpp"
#include "apps/run_options.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"
#include "rig/open_stereo.hpp"
#include "rig/rig.hpp"
#include "scene/target_folder.hpp"
#include "session/encoder_poses.hpp"
#include "session/recorder_options.hpp"
#include "session/recording.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

struct RecordArguments {
  std::string out, rig, left, right, format = "yuyv";
  std::vector<std::string> images;
  std::string camera, camera_right, scene;
  std::vector<double> pose;
  bool mock = false;
  double rate = 30;
  std::optional<double> seconds;
  std::optional<std::uint64_t> count;
  RecordLineOptions line;  // what is said on a line, instead of cameras: only with line.file
};

Pose parse_pose(const std::vector<double>& v) {
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1) < 1e-3))
    throw InputError("--pose", "qx qy qz qw have the length " + std::to_string(q.norm()), "give a unit quaternion");
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(v[0], v[1], v[2]));
  pose.rotate(q.normalized());
  return pose;
}

void check(const RecordArguments& a) {
  const int kinds = int(!a.images.empty()) + int(!a.left.empty() || !a.right.empty()) + int(!a.rig.empty());
  if (kinds > 1 || (a.mock && kinds > 0 && a.rig.empty()))
    throw InputError(a.mock ? "--mock" : "--left, --right, --images, --rig", "stand beside other cameras",
                     "choose one kind of cameras");
  if (kinds == 0 && !a.mock)
    throw InputError("--left, --right, --images, --rig", "say which cameras",
                     "give --left and --right, or --images LEFTDIR RIGHTDIR, or --rig RIG, or --mock");
  if (a.left.empty() != a.right.empty())
    throw InputError(a.left.empty() ? "--left" : "--right", "is missing", "name both cameras");
  if (a.mock) {
    if (!a.scene.empty() || !a.pose.empty() || !a.camera_right.empty())
      throw InputError("--mock", "knows its scene, poses and right camera",
                       "leave --scene, --pose, --camera-right out");
    return;
  }
  if (a.rig.empty() && a.camera.empty())
    throw InputError("--camera", "is missing", "give the left camera's calibration, or choose --mock");
  if (a.rig.empty() && a.camera_right.empty())
    throw InputError("--camera-right", "is missing", "give the right camera's calibration, with T_left_right in it");
}

struct Described {
  StereoConfig cameras;
  std::optional<Rig> rig;
  std::optional<fs::path> tags, scene;  // the rig's; --scene goes before it
};

Described described(const RecordArguments& a) {
  Described all;
  StereoConfig& out = all.cameras;
  if (!a.scene.empty()) all.scene = a.scene;
  if (!a.rig.empty()) {
    all.rig = read_rig(a.rig);
    const Rig& rig = *all.rig;
    if (rig.calibration) all.tags = rig.calibration->tags;
    if (!all.scene) all.scene = rig.scene;
    if (!rig.cameras) throw InputError(a.rig, "the rig has no cameras", "add them (docs/rig-files.md)");
    out = *rig.cameras;
    if (rig.calibration && rig.calibration->pan_tilt && !a.mock)
      std::fputs("record: nobody reads the rig's encoders here; `foresight robot RIG --record` writes poses\n", stderr);
  }
  for (const bool right : {false, true}) {
    CameraConfig& camera = out.cameras[right ? 1 : 0];
    if (!a.images.empty()) {
      camera.driver = CameraDriver::images;
      camera.device = a.images[right ? 1 : 0];
      camera.repeat = false;
    } else if (!a.left.empty()) {
      camera = camera_by_name(right ? a.right : a.left);
    }
    if (const std::string& file = right ? a.camera_right : a.camera; !file.empty()) {
      camera.calibration = read_camera_info(file);
      camera.settings.width = camera.calibration->lens.width();
      camera.settings.height = camera.calibration->lens.height();
    }
    if (!a.rig.empty()) continue;
    camera.settings.rate = a.rate;
    camera.settings.format = parse_pixel_format(a.format, "--format");
  }
  if (!a.mock) return all;
  if (!a.camera.empty()) {  // both cameras alike
    out.cameras[1].calibration = CameraInfo{out.cameras[0].calibration->lens, {}};
    out.cameras[1].settings = out.cameras[0].settings;
  }
  out = as_mock(out);
  return all;
}

/// Of real cameras without the rig's robot: nobody knows here how its joints stand.
LiveScene scene_of(const Described& all, const OpenStereo& opened) {
  if (opened.mock) return LiveScene(*opened.mock);
  if (!all.scene)
    std::fputs("record: no --scene and none in the rig, so that `foresight replay` will need one\n", stderr);
  return LiveScene(all.cameras, nullptr, all.scene);
}

GivenPoses poses_of(const RecordArguments& a, const std::shared_ptr<const LiveScene>& scene,
                    const sim::ShaftsAt& shafts) {
  if (scene->is_mock())
    return {scene,
            [scene, shafts](RobotTime t) {
              return scene->T_world_left([&](std::string_view joint) { return shafts(joint, t); });
            },
            shafts};
  if (!a.pose.empty()) return {scene, [pose = parse_pose(a.pose)](RobotTime) { return pose; }};
  std::fputs("record: no --pose, so that the run needs a trajectory.txt before it can be replayed\n", stderr);
  return {scene, {}};
}

int record_and_report(const RecordArguments& a, const OpenStereo& opened, LiveFrames& frames, RecorderOptions options,
                      Clock& clock) {
  for (const fs::path& cut : unfinished_beside(a.out))
    std::fprintf(stderr, "record: %s is a recording that was not finished: rename it, or remove it\n", cut.c_str());
  RunRecorder recorder(a.out, std::move(options), frames.subscribe(RunRecorder::kRoom));
  RecordingLimits limits;
  limits.count = a.count;
  if (a.seconds) limits.length = seconds(*a.seconds);
  if (!a.images.empty()) limits.silent_after = std::chrono::seconds(1);  // the end of the files
  if (opened.mock) limits.silent_after = std::chrono::minutes(2);        // a renderer may be slow; it is not unplugged
  poll_stop_signals();
  const RecordingResult result = record(*opened.cameras, frames, recorder, limits, clock, stop_requested);
  std::fprintf(stderr, "record: %s", counts_text(result).c_str());
  std::printf("%s\n", a.out.c_str());
  const bool all_played = !a.images.empty() && !recorder.stopped();
  if (result.fault.empty() || all_played) return 0;
  std::fprintf(stderr, "foresight: %s; what came before is in %s\n", result.fault.c_str(), a.out.c_str());
  return 1;
}

int run_line(const RecordArguments& a) {
  const std::pair<const char*, bool> cameras[] = {
      {"OUT", !a.out.empty()},         {"--left, --right", !a.left.empty() || !a.right.empty()},
      {"--images", !a.images.empty()}, {"--camera, --camera-right", !(a.camera + a.camera_right).empty()},
      {"--scene", !a.scene.empty()},   {"--pose", !a.pose.empty()},
      {"--count", a.count.has_value()}};
  for (const auto& [option, given] : cameras)
    if (given) throw InputError(option, "stands beside --line, which opens no cameras", "leave one of them out");
  RecordLineOptions options = a.line;
  options.place.rig = a.rig;
  options.mock = a.mock;
  options.seconds = a.seconds;
  return record_line(options);
}

int run(const RecordArguments& a) {
  if (!a.line.file.empty()) return run_line(a);
  const LinkPlace& place = a.line.place;
  if (place.domain || !(place.interface + place.keys).empty() || !place.peers.empty() || a.line.pictures)
    throw InputError("--domain, --interface, --keys, --peer, --pictures", "belong to --line",
                     "add it, or leave them out");
  if (a.out.empty())
    throw InputError("OUT", "is missing", "name the folder to write, or record a line with --line FILE");
  MonotonicClock clock;
  check(a);
  const Described all = described(a);
  const StereoConfig& config = all.cameras;
  const RobotTime start = clock.now();
  const sim::ShaftsAt shafts = moving_shafts(start);
  if (config.mock()) std::fputs("record: lighting the lab\n", stderr);
  const MockWorld world = config.mock() && all.rig ? mock_world(*all.rig) : MockWorld{};
  const OpenStereo opened = open_stereo(config, shafts, clock, world);
  const auto scene = std::make_shared<const LiveScene>(scene_of(all, opened));
  RecorderOptions options = recorder_options(*scene);
  options.posed = opened.mock || !a.pose.empty();
  options.tags = all.tags;
  LiveFrames frames(std::make_shared<GivenPoses>(poses_of(a, scene, shafts)), clock);
  const int code = record_and_report(a, opened, frames, std::move(options), clock);
  if (opened.mock) write_head_joints(beside_run(a.out, "-joints.csv"), shafts, start, clock.now());
  if (const std::uint64_t skipped = opened.mock ? opened.mock->skipped() : 0)
    std::fprintf(stderr, "record: %llu instants not rendered: this machine is too slow for %g Hz at that size\n",
                 static_cast<unsigned long long>(skipped), opened.mock->rate());
  return code;
}

}  // namespace

void add_record_command(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("record", "Write what two cameras see as a run, or what is said on a line");
  auto a = std::make_shared<RecordArguments>();
  command->add_option("OUT", a->out, "Folder to write; an earlier recording in it is replaced")
      ->writes(recording_outputs);
  command
      ->add_option("--line", a->line.file,
                   "Instead of cameras, all that is said on a line, into this new file (MCAP); --rig, --mock and "
                   "--seconds\nbelong to it, too (docs/line.md)")
      ->writes([](const std::filesystem::path& file) -> std::vector<Output> {
        return {new_output(file, Output::Kind::file)};
      });
  command->add_flag("--pictures", a->line.pictures,
                    "With --line: also the copies of the pictures for ROS 2's tools: twice the bytes on the line");
  add_link_place(*command, a->line.place);
  command->add_option("--rig", a->rig, "The cameras of a rig file (docs/rig-files.md)")->reads();
  command->add_option("--left", a->left, "V4L2 device: a path, serial:... or bus:...; or libcamera:... and its id")
      ->reads();
  command->add_option("--right", a->right, "The right camera's")->reads();
  command->add_option("--images", a->images, "Folders of numbered images instead: LEFTDIR RIGHTDIR")
      ->reads()
      ->expected(2);
  command->add_flag("--mock", a->mock,
                    "The mock lab in motion instead, with its scene and poses; with --rig, as its cameras see it");
  command->add_option("--camera", a->camera, "Calibration of the left camera (camera.yaml)")->reads();
  command->add_option("--camera-right", a->camera_right, "Of the right one, with T_left_right")->reads();
  command->add_option("--scene", a->scene, "Scene or mesh, stored with the run; in place of the rig's")->reads();
  command->add_option("--pose", a->pose, "Where the left camera stands, fixed: x y z qx qy qz qw, camera to world")
      ->check(from_to(-1e6, 1e6))
      ->expected(7);
  command->add_option("--format", a->format, "Pixel format of the devices")->capture_default_str();
  command->add_option("--rate", a->rate, "Images per second")->check(from_to(0.1, 1000))->capture_default_str();
  command->add_option("--seconds", a->seconds, "Ends after so long")->check(from_to(0.001, 1e6));
  command->add_option("--count", a->count, "Ends after so many pairs")->check(from_to(1, 1e9));
  command->footer(
      "Ctrl-C ends a recording and keeps it.\n\n"
      "Exit codes: 0 done, 1 a camera fell silent or the disk is full (what came before is kept), 2 wrong input.\n\n"
      "Example: foresight record run --left serial:A1 --right serial:A2 --camera left.yaml --camera-right right.yaml\n"
      "         foresight record run --rig my_rig.yaml --seconds 60\n"
      "         foresight record run --mock --seconds 5\n"
      "         foresight record --line session.mcap --rig my_rig.yaml");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
