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
#include "sim/run_files.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t interrupted = 0;

struct Arguments {
  std::string out, left, right, format = "yuyv";
  std::vector<std::string> images;
  std::string camera, camera_right, scene;
  std::vector<double> pose;
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

void check(const Arguments& a) {
  if (a.images.empty() == (a.left.empty() && a.right.empty()))
    throw InputError("--left, --right, --images", "say which cameras",
                     "give either --left and --right, or --images LEFTDIR RIGHTDIR");
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

int run(const Arguments& a) {
  check(a);
  MonotonicClock clock;
  RecorderOptions options = recorder_options(a);
  StereoCamera cameras(open_camera(a, false, options.left, clock), open_camera(a, true, options.right, clock), clock);
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

}  // namespace

void add_record_command(CLI::App& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("record", "Write what two cameras see as a run");
  auto a = std::make_shared<Arguments>();
  command->add_option("OUT", a->out, "Folder to write; an earlier recording in it is replaced")->required();
  command->add_option("--left", a->left, "V4L2 device: a path, serial:... or bus:...");
  command->add_option("--right", a->right, "The right camera's");
  command->add_option("--images", a->images, "Folders of numbered images instead: LEFTDIR RIGHTDIR")->expected(2);
  command->add_option("--camera", a->camera, "Calibration of the left camera (camera.yaml)")->required();
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
      "Example: foresight record run --left serial:A1 --right serial:A2 --camera left.yaml --camera-right right.yaml");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
