#include "apps/calibrate/capture_command.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/calibrate/capture_loop.hpp"
#include "apps/calibrate/exposure_capture.hpp"
#include "apps/calibrate/mock_board.hpp"
#include "apps/calibrate/outputs.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"
#include "gl/glfw_window.hpp"
#include "rig/rig_scene.hpp"

namespace foresight {
namespace {

struct CaptureArguments {
  std::string board, out, pictures, rig, only, left, right, camera;
  std::vector<std::string> images;
  std::vector<double> exposures;  // s; of a still scene, in place of a board
  bool mock = false;
  double rate = 0;
  int views = CaptureGuide::Options{}.views;
  double seconds = 600;
  unsigned seed = 1;
  bool window = false, no_window = false;  // neither: where there is a display
  std::optional<std::filesystem::path> json;
};

void require_one_source(const CaptureArguments& a) {
  const int kinds =
      int(!a.images.empty()) + int(!a.left.empty() || !a.right.empty()) + int(!a.rig.empty()) + int(!a.camera.empty());
  if (kinds > 1 || (kinds == 0 && !a.mock))
    throw InputError("--rig, --left, --right, --camera, --images", "say which cameras",
                     "give one of --rig RIG, --left and --right, --camera SELECTOR for a lone one, --images DIR or "
                     "LEFTDIR RIGHTDIR, --mock");
  if (a.left.empty() != a.right.empty())
    throw InputError(a.left.empty() ? "--left" : "--right", "is missing",
                     "name both cameras, or a lone one by --camera");
  if (!a.only.empty() && a.rig.empty())
    throw InputError("--only", "chooses one of a rig's cameras", "give --rig RIG, or leave it out");
  if (a.mock && !a.camera.empty())
    throw InputError("--mock", "stands beside --camera", "give one of them; --mock goes with --rig or alone");
}

bool is_stereo(const CaptureArguments& a) {
  return a.camera.empty() && a.only.empty() && a.images.size() != 1;
}

StereoConfig described(const CaptureArguments& a) {
  StereoConfig config;
  if (!a.rig.empty()) {
    const Rig rig = read_rig(a.rig);
    if (!rig.cameras) throw InputError(a.rig, "the rig has no cameras", "add them (docs/rig-files.md)");
    config = *rig.cameras;
  }
  for (const bool right : {false, true}) {
    CameraConfig& camera = config.cameras[right ? 1 : 0];
    if (!a.left.empty()) camera = camera_by_name(right ? a.right : a.left);
    if (a.rate > 0) camera.settings.rate = a.rate;
  }
  return a.mock ? as_mock(config) : config;
}

CameraConfig lone_camera(const CaptureArguments& a) {
  CameraConfig config;
  if (!a.camera.empty()) {
    config = camera_by_name(a.camera);
    if (a.rate > 0) config.settings.rate = a.rate;
  } else {
    config = described(a).camera(a.only == "right" ? Side::right : Side::left);
  }
  if (config.driver == CameraDriver::mock)
    throw InputError("--only", "a lone mock camera has no world", "capture both, and use one folder");
  return config;
}

bool wants_window(const CaptureArguments& a) {
  return a.window || (!a.no_window && has_display());
}

struct Clocks {
  MonotonicClock real;
  SteppedClock stepped;
};

struct Opened {
  std::unique_ptr<CaptureSource> source;
  Clock& clock;
};

/// Mock cameras that nobody watches run in stepped time: repeatable, and as fast as the machine is.
Opened open_source(const CaptureArguments& a, const Board& board, Clocks& clocks) {
  if (!a.images.empty()) return {folder_source(a.images), clocks.real};
  if (!is_stereo(a))
    return {lone_source(make_camera(a.only.empty() ? "camera" : a.only, lone_camera(a), clocks.real)), clocks.real};
  StereoConfig config = described(a);
  if (!config.mock()) return {pair_source(open_stereo(config, {}, clocks.real)), clocks.real};
  Clock& clock = wants_window(a) ? static_cast<Clock&>(clocks.real) : clocks.stepped;
  if (!wants_window(a) && a.rate <= 0)
    for (CameraConfig& camera : config.cameras) camera.settings.rate = MockBoard::kRate;
  return {mock_board_source(config, board, a.seed, clock), clock};
}

CaptureEnd capture(const CaptureArguments& a, CaptureSource& source, CaptureSession& session, const Clock& clock) {
  CaptureLoopOptions options{a.pictures, seconds(a.seconds)};
  if (wants_window(a)) try {
      return capture_with_window(source, session, clock, options);
    } catch (const gl::NoWindow& failure) {
      if (a.window) throw RuntimeFailure(failure.what(), "or leave out --window");
      std::fprintf(stderr, "capture: %s\n", failure.what());
    }
  if (options.pictures.empty()) options.pictures = a.out + "-seen";
  std::fprintf(stderr, "capture: without a window (--window opens one); look at %s\n",
               (options.pictures / "now.png").c_str());
  return capture_with_pictures(source, session, clock, options);
}

void print_next_command(const CaptureArguments& a, const CaptureSession& session) {
  const std::string board = to_string(session.board());
  if (session.stereo())
    std::printf("foresight calibrate stereo --board %s --left %s/left --right %s/right\n", board.c_str(), a.out.c_str(),
                a.out.c_str());
  else
    std::printf("foresight calibrate intrinsics --board %s --images %s\n", board.c_str(), a.out.c_str());
}

int report(const CaptureArguments& a, const CaptureSession& session, CaptureEnd end) {
  const CaptureProgress progress = session.progress();
  nlohmann::ordered_json numbers{{"board", to_string(session.board())},
                                 {"cameras", session.stereo() ? 2 : 1},
                                 {"views", progress.views},
                                 {"enough", progress.enough},
                                 {"ended", to_string(end)},
                                 {"coverage", progress.coverage()},
                                 {"missing", progress.wish.text}};
  if (!progress.uncertainty.empty()) {
    double most = 0;
    cv::minMaxLoc(progress.uncertainty, nullptr, &most);
    numbers["uncertainty_mean_px"] = cv::mean(progress.uncertainty)[0];
    numbers["uncertainty_worst_px"] = most;
  }
  write_json(a.json, numbers);
  if (progress.views > 0) print_next_command(a, session);
  if (progress.enough) return 0;
  const std::string kept = progress.views == 0 ? "nothing was taken"
                           : progress.views == 1
                               ? "1 view, kept in " + a.out + ", is not enough"
                               : counted(progress.views, "view") + ", kept in " + a.out + ", are not enough";
  std::fprintf(stderr, "foresight: %s: %s; %s\n", to_string(end), kept.c_str(),
               progress.wish.text.empty() ? "show more views" : progress.wish.text.c_str());
  return end == CaptureEnd::interrupted ? kStopped : 1;
}

/// Slow enough that the middles of the exposures come one after the other.
constexpr double kMockSeriesRate = 20;

std::unique_ptr<ExposedCameras> open_exposed(const CaptureArguments& a, StereoConfig config, Clocks& clocks) {
  if (config.mock()) {
    for (CameraConfig& camera : config.cameras) camera.settings.rate = kMockSeriesRate;
    const MockWorld world = a.rig.empty() ? MockWorld{} : mock_world(read_rig(a.rig));
    const auto shafts = [](std::string_view joint, RobotTime) { return sim::shafts_at_rest(joint); };
    return exposed_mock_cameras(open_stereo(config, shafts, clocks.stepped, world), clocks.stepped);
  }
  const auto open = [&a, config, &clocks](Duration exposure) -> std::unique_ptr<CaptureSource> {
    StereoConfig exposed = config;
    for (CameraConfig& camera : exposed.cameras) camera.settings.exposure = exposure;
    if (is_stereo(a)) return pair_source(open_stereo(exposed, {}, clocks.real));
    return lone_source(make_camera("camera", exposed.cameras[0], clocks.real));
  };
  return reopened_cameras(open, clocks.real);
}

int run_exposures(const CaptureArguments& a) {
  if (!a.board.empty() || !a.images.empty())
    throw InputError("--exposures", std::string("stands beside ") + (a.board.empty() ? "--images" : "--board"),
                     "give one of them: pictures of a board, or of a still scene at several exposure times");
  StereoConfig config;
  if (is_stereo(a))
    config = described(a);
  else
    config.cameras[0] = lone_camera(a);
  const Duration longest = config.mock() ? sim::MockStereo::kLongestExposure * Duration{100'000}
                                         : seconds(1 / config.cameras[0].settings.rate);
  const ExposureSeries series{a.out, exposure_times(a.exposures, longest), is_stereo(a)};
  Clocks clocks;
  const auto cameras = open_exposed(a, config, clocks);
  const bool whole = take_exposure_series(*cameras, series);
  const char* const out = a.out.c_str();
  write_json(a.json, {{"cameras", series.stereo ? 2 : 1}, {"exposures_s", a.exposures}, {"whole", whole}});
  if (!whole) {
    std::fprintf(stderr, "foresight: interrupted; what was taken is in %s\n", out);
    return kStopped;
  }
  if (series.stereo)
    std::printf("foresight calibrate photometric --left %s/left --right %s/right --exposures %s/exposures.txt\n", out,
                out, out);
  else
    std::printf("foresight calibrate photometric --images %s --exposures %s/exposures.txt\n", out, out);
  return 0;
}

int run(const CaptureArguments& a) {
  require_one_source(a);
  if (!a.exposures.empty()) return run_exposures(a);
  if (a.board.empty())
    throw InputError("--board", "is missing", "name the board that is shown, such as chessboard:9x6:0.025");
  Clocks clocks;
  const Board board = parse_board(a.board);
  const auto [source, clock] = open_source(a, board, clocks);
  CaptureSession::Options options;
  options.out = a.out;
  options.stereo = is_stereo(a);
  options.guide.views = a.views;
  if (source->stills()) options.guide.moved_px = 0;
  CaptureSession session(board, options);
  return report(a, session, capture(a, *source, session, clock));
}

std::vector<Output> now_outputs(const std::filesystem::path& folder) {
  return {{folder, Output::Kind::folder}, {folder / "now.png", Output::Kind::file, png_form()}};
}

void refuse_files(const std::string& where, const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (!entry.is_directory())
      throw InputError(where, "already holds files, such as " + entry.path().filename().string(),
                       "name a new folder, or empty it");
}

std::vector<Output> capture_outputs(const CaptureArguments& a, const std::filesystem::path& out) {
  std::vector<Output> all;
  if (a.pictures.empty() && a.exposures.empty()) all = now_outputs(out.string() + "-seen");
  all.push_back({out, Output::Kind::folder, {}, refuse_files});
  return all;
}

}  // namespace

void add_capture(Command& calibrate, std::function<int()>& action) {
  auto* command = calibrate.add_subcommand(
      "capture", "Take images of a board until they are enough, or of a still scene at several exposures");
  auto a = std::make_shared<CaptureArguments>();
  command->add_option("--board", a->board, "chessboard|charuco|apriltag|circles:COLSxROWS:SIZE_M[:EXTRA[:FAMILY]]");
  command
      ->add_option("--exposures", a->exposures,
                   "Instead of a board: a still scene at these exposure times, s, for `calibrate photometric`;\n"
                   "automatic gain and white balance must be off")
      ->expected(3, 100);
  command->add_option("--out", a->out, "New folder; left/ and right/ in it for a pair")
      ->writes([a](const std::filesystem::path& out) { return capture_outputs(*a, out); })
      ->required();
  command
      ->add_option("--pictures", a->pictures,
                   "Folder for now.png, what the window would show (without a window: OUT-seen)")
      ->writes(now_outputs);
  auto* window = command->add_flag("--window", a->window, "Open a window (default: where there is a display)");
  command->add_flag("--no-window", a->no_window, "Open none")->excludes(window);
  command->add_option("--rig", a->rig, "Rig file with both cameras")->reads();
  command->add_option("--only", a->only, "Of --rig, this camera alone")->check(one_of({"left", "right"}));
  command->add_option("--left", a->left, "Device: a path, serial:..., bus:... or libcamera:...")->reads();
  command->add_option("--right", a->right, "The right camera's")->reads();
  command->add_option("--camera", a->camera, "A lone camera: the same forms")->reads();
  command->add_option("--images", a->images, "Folders of images instead: DIR of a lone camera, or LEFTDIR RIGHTDIR")
      ->reads()
      ->expected(1, 2);
  command->add_flag("--mock", a->mock, "The mock lab's cameras instead, with the board held before them");
  command->add_option("--seed", a->seed, "Of the mock lab: another way to hold the board");
  command->add_option("--rate", a->rate, "Images per second")->check(from_to(0.1, 1000.0));
  command->add_option("--views", a->views, "Views to take at least")->check(from_to(5, 1000));
  command->add_option("--seconds", a->seconds, "Longest time")->check(from_to(1e-9, 1e9));
  command->add_option("--json", a->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight calibrate capture --rig configs/minerva.yaml --board charuco:8x5:0.03:0.022:DICT_5X5_100 "
      "--out set\n         foresight calibrate capture --camera /dev/video0 --board chessboard:9x6:0.025 --out set\n"
      "         foresight calibrate capture --rig configs/minerva.yaml --exposures 0.0005 0.001 0.002 0.004 0.008 "
      "0.016 "
      "0.03 --out series\n"
      "In the window: Space takes what is seen now, Escape or Q ends; what was taken stays.");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
