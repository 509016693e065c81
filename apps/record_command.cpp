#include "apps/record_command.hpp"

#include <csignal>
#include <cstdio>
#include <memory>

#include "apps/record/recording.hpp"
#include "apps/run_options.hpp"
#include "common/error.hpp"
#include "drivers/camera/image_folder_camera.hpp"
#include "drivers/camera/v4l2_camera.hpp"
#include "scene/camera_info.hpp"
#include "scene/scene_reader.hpp"
#include "sim/live_view/mock_camera.hpp"
#include "sim/run_files.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t interrupted = 0;

struct Arguments {
  std::string out, left, right, format = "yuyv";
  std::vector<std::string> images;
  std::string camera, camera_right, scene;
  std::vector<double> pose;
  bool mock = false;
  double rate = 30;
  std::optional<double> seconds;
  std::optional<std::uint64_t> count;
};

std::unique_ptr<Camera> open_camera(const Arguments& a, bool right, const Lens& lens, Clock& clock) {
  const std::string name = right ? "right" : "left";
  if (!a.images.empty()) {
    ImageFolderCamera::Options options;
    options.rate = a.rate;
    options.repeat = false;
    return std::make_unique<ImageFolderCamera>(name, a.images[right ? 1 : 0], options, clock);
  }
  V4l2Camera::Options options;
  options.device = right ? a.right : a.left;
  options.settings.width = lens.width();
  options.settings.height = lens.height();
  options.settings.rate = a.rate;
  options.settings.format = parse_pixel_format(a.format, "--format");
  return std::make_unique<V4l2Camera>(name, options, clock);
}

Pose parse_pose(const std::vector<double>& v) {
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1) < 1e-3))
    throw InputError("--pose", "qx qy qz qw have the length " + std::to_string(q.norm()), "give a unit quaternion");
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(v[0], v[1], v[2]));
  pose.rotate(q.normalized());
  return pose;
}

/// The mock lab in front of its cameras, and how it is recorded.
struct Mock {
  std::shared_ptr<const sim::LiveLab> world;
  std::shared_ptr<sim::MockStereo> stereo;

  Mock(const Lens& left, const Lens& right, double rate, Clock& clock)
      : world(std::make_shared<const sim::LiveLab>(sim::LiveLab::Options{})) {
    sim::MockCameraOptions options;
    options.left = left;
    options.right = right;
    options.rate = rate;
    const auto shafts = [start = clock.now()](std::string_view joint, RobotTime time) {
      return sim::shafts_in_motion(joint, to_seconds(time - start));
    };
    stereo = std::make_shared<sim::MockStereo>(world, shafts, options, clock);
    poses_ = [shafts, w = world](RobotTime time) {
      const sim::ShaftPositions now = [&](std::string_view joint) { return shafts(joint, time); };
      RecordedPoses poses{sim::LiveLab::T_world_left_modelled(now), {}};
      const sim::LabState state = w->modelled_state(now);
      for (std::size_t k = 0; k < state.size(); ++k)
        if (const sim::Part& part = w->lab().parts[k]; part.moves && part.name != sim::kBall)
          poses.T_world_node.emplace_back(part.name, state[k]);
      return poses;
    };
  }

  /// The encoders' word for head and arm. The ball has no encoder: the model leaves it at rest.
  void describe(RecorderOptions& options) const {
    options.T_left_right = sim::T_head_left_right();
    options.poses = poses_;
    options.write_scene = [w = world](const fs::path& folder) {
      sim::ArmPosition arm;
      for (std::size_t j = 0; j < arm.joints.size(); ++j)
        arm.joints[j] = *sim::shafts_at_rest(sim::arm_joints()[j].name);
      sim::write_scene(folder, w->lab(), arm);
    };
  }

 private:
  std::function<RecordedPoses(RobotTime)> poses_;
};

void check_mock(const Arguments& a) {
  if (!a.images.empty() || !a.left.empty() || !a.right.empty())
    throw InputError("--mock", "stands beside other cameras", "choose one kind of cameras");
  if (!a.scene.empty() || !a.pose.empty() || !a.camera_right.empty())
    throw InputError("--mock", "knows its scene, poses and right camera", "leave --scene, --pose, --camera-right out");
}

void check(const Arguments& a) {
  if (a.camera.empty())
    throw InputError("--camera", "is missing", "give the left camera's calibration, or choose --mock");
  if (a.images.empty() == (a.left.empty() && a.right.empty()))
    throw InputError("--left, --right, --images", "say which cameras",
                     "give --left and --right, or --images LEFTDIR RIGHTDIR, or --mock");
  if (a.images.empty() && (a.left.empty() || a.right.empty()))
    throw InputError(a.left.empty() ? "--left" : "--right", "is missing", "name both cameras");
  if (a.camera_right.empty())
    throw InputError("--camera-right", "is missing", "give the right camera's calibration, with T_left_right in it");
  if (a.scene.empty()) std::fputs("record: no --scene, so that `foresight replay` will need one\n", stderr);
  if (a.pose.empty())
    std::fputs("record: no --pose, so that the run needs a trajectory.txt before it can be replayed\n", stderr);
}

RecorderOptions recorder_options(const Arguments& a) {
  RecorderOptions options;
  options.left = read_camera_info(a.camera).lens;
  const CameraInfo right = read_camera_info(a.camera_right);
  if (!right.T_left_right)
    throw InputError(a.camera_right + ": T_left_right", "is missing", "say where the right camera is");
  options.right = right.lens;
  options.T_left_right = *right.T_left_right;
  if (!a.pose.empty()) options.poses = [pose = parse_pose(a.pose)](RobotTime) { return RecordedPoses{pose, {}}; };
  if (!a.scene.empty()) {
    const fs::path file = fs::absolute(a.scene);
    options.write_scene = [scene = read_scene(file, file.parent_path())](const fs::path& folder) {
      sim::write_model(folder, scene);
    };
  }
  return options;
}

int record_and_report(const Arguments& a, StereoCamera& cameras, RecorderOptions options, Clock& clock) {
  RunRecorder recorder(a.out, std::move(options));
  RecordingLimits limits;
  limits.count = a.count;
  if (a.seconds) limits.length = seconds(*a.seconds);
  if (!a.images.empty()) limits.silent_after = std::chrono::seconds(1);  // the end of the files
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = 1; });
  const RecordingResult result = record(cameras, recorder, limits, clock, [] { return interrupted != 0; });
  std::fprintf(stderr, "record: %s", counts_text(result).c_str());
  std::printf("%s\n", a.out.c_str());
  const bool all_played = !a.images.empty() && !recorder.disk_full();
  if (result.fault.empty() || all_played) return 0;
  std::fprintf(stderr, "foresight: %s; what came before is in %s\n", result.fault.c_str(), a.out.c_str());
  return 1;
}

int run_mock(const Arguments& a, Clock& clock) {
  check_mock(a);
  sim::SynthOptions usual;
  usual.width = 640;
  usual.height = 480;
  RecorderOptions options;
  options.left = a.camera.empty() ? sim::synth_lens(usual, false) : read_camera_info(a.camera).lens;
  options.right = a.camera.empty() ? sim::synth_lens(usual, true) : options.left;
  std::fputs("record: lighting the lab\n", stderr);
  const Mock mock(options.left, options.right, a.rate, clock);
  mock.describe(options);
  StereoCamera cameras(std::make_unique<sim::MockCamera>("left", Side::left, mock.stereo),
                       std::make_unique<sim::MockCamera>("right", Side::right, mock.stereo), clock);
  const int code = record_and_report(a, cameras, std::move(options), clock);
  if (const std::uint64_t skipped = mock.stereo->skipped())
    std::fprintf(stderr, "record: %llu instants not rendered: this machine is too slow for %g Hz at that size\n",
                 static_cast<unsigned long long>(skipped), a.rate);
  return code;
}

int run(const Arguments& a) {
  MonotonicClock clock;
  if (a.mock) return run_mock(a, clock);
  check(a);
  RecorderOptions options = recorder_options(a);
  StereoCamera cameras(open_camera(a, false, options.left, clock), open_camera(a, true, options.right, clock), clock);
  return record_and_report(a, cameras, std::move(options), clock);
}

}  // namespace

void add_record_command(CLI::App& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("record", "Write what two cameras see as a run");
  auto a = std::make_shared<Arguments>();
  command->add_option("OUT", a->out, "Folder to write; an earlier recording in it is replaced")->required();
  command->add_option("--left", a->left, "V4L2 device: a path, serial:... or bus:...");
  command->add_option("--right", a->right, "The right camera's");
  command->add_option("--images", a->images, "Folders of numbered images instead: LEFTDIR RIGHTDIR")->expected(2);
  command->add_flag("--mock", a->mock, "The mock lab in motion instead, with its scene and poses");
  command->add_option("--camera", a->camera, "Calibration of the left camera (camera.yaml)");
  command->add_option("--camera-right", a->camera_right, "Of the right one, with T_left_right");
  command->add_option("--scene", a->scene, "Scene or mesh, stored with the run");
  command->add_option("--pose", a->pose, "Where the left camera stands, fixed: x y z qx qy qz qw, camera to world")
      ->expected(7);
  command->add_option("--format", a->format, "Pixel format of the devices")->capture_default_str();
  command->add_option("--rate", a->rate, "Images per second")->check(from_to(0.1, 1000))->capture_default_str();
  command->add_option("--seconds", a->seconds, "Ends after so long")->check(from_to(0.001, 1e6));
  command->add_option("--count", a->count, "Ends after so many pairs")->check(from_to(1, 1e9));
  command->footer(
      "Ctrl-C ends a recording and keeps it.\n\n"
      "Exit codes: 0 done, 1 a camera fell silent or the disk is full (what came before is kept), 2 wrong input.\n\n"
      "Example: foresight record run --left serial:A1 --right serial:A2 --camera left.yaml --camera-right right.yaml\n"
      "         foresight record run --mock --seconds 5");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
