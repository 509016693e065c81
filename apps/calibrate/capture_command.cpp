#include "apps/calibrate/capture_command.hpp"

#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/calibrate/outputs.hpp"
#include "apps/cameras/open_stereo.hpp"
#include "calibration/target/capture_session.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/robot/rig.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

volatile std::sig_atomic_t interrupted = 0;

struct Arguments {
  std::string board, out, pictures, rig, left, right;
  std::vector<std::string> images;
  bool mock = false;
  double rate = 0;
  int views = CaptureGuide::Options{}.views;
  double seconds = 600;
  std::optional<std::filesystem::path> json;
};

StereoConfig described(const Arguments& a) {
  const int kinds = int(!a.images.empty()) + int(!a.left.empty() || !a.right.empty()) + int(!a.rig.empty());
  if (kinds > 1 || (kinds == 0 && !a.mock))
    throw InputError("--rig, --left, --right, --images", "say which cameras",
                     "give one of --rig RIG, --left and --right, --images LEFTDIR RIGHTDIR, --mock");
  if (a.left.empty() != a.right.empty())
    throw InputError(a.left.empty() ? "--left" : "--right", "is missing", "name both cameras");
  StereoConfig config;
  if (!a.rig.empty()) {
    const Rig rig = read_rig(a.rig);
    if (!rig.cameras) throw InputError(a.rig, "the rig has no cameras", "add them (docs/rig-files.md)");
    config = *rig.cameras;
  }
  for (const bool right : {false, true}) {
    CameraConfig& camera = config.cameras[right ? 1 : 0];
    if (!a.images.empty()) {
      camera.driver = CameraDriver::images;
      camera.device = a.images[right ? 1 : 0];
      camera.repeat = false;
      camera.settings.rate = 3;  // each picture counts: slower than the finder
    } else if (!a.left.empty()) {
      camera = camera_by_name(right ? a.right : a.left);
    }
    if (a.rate > 0) camera.settings.rate = a.rate;
  }
  // Folders are started one after the other; what belongs together is less than half a period apart.
  if (!a.images.empty()) {
    const double period_s = 1 / config.cameras[0].settings.rate;
    config.pairing.tolerance = seconds(0.45 * period_s);
    config.pairing.frozen_after = std::max(config.pairing.frozen_after, seconds(3 * period_s));
  }
  return a.mock ? as_mock(config) : config;
}

void say(const CaptureGuide& guide, const CaptureGuide::Verdict& verdict, std::string& last) {
  const std::string wish = guide.wish();
  std::string text = verdict.taken ? "taken, " + std::to_string(guide.views()) + " views" : verdict.reason;
  if (!guide.enough()) text += "; next: " + (wish.empty() ? "another view, turned or moved" : wish);
  if (text == last) return;
  std::fprintf(stderr, "capture: %s\n", text.c_str());
  last = text;
}

struct Stopping {  // also where something throws
  StereoCamera& cameras;
  ~Stopping() { cameras.stop(); }
};

/// Until it is enough, the time is up, or the cameras have been silent for some seconds.
void loop(const Arguments& a, StereoCamera& cameras, CaptureSession& session, const Clock& clock) {
  const Duration silent_after = a.images.empty() ? 5s : 2s;
  cameras.start();
  const Stopping stopping{cameras};
  const RobotTime begin = clock.now();
  RobotTime heard = begin;
  std::string last;
  while (interrupted == 0 && !(session.guide() && session.guide()->enough()) &&
         clock.now() - begin < seconds(a.seconds)) {
    const auto pair = cameras.take(100ms);
    if (!pair) {
      if (clock.now() - heard <= silent_after) continue;
      if (!session.guide())
        throw RuntimeFailure(std::string("no pair of images came: ") + cameras.status().reason,
                             "check the cables, and `foresight doctor`");
      std::fprintf(stderr, "capture: no more pairs of images\n");
      return;
    }
    const auto verdict = session.show(pair->left.bgr, pair->right.bgr);
    heard = clock.now();
    say(*session.guide(), verdict, last);
  }
}

int report(const Arguments& a, const CaptureSession& session) {
  const CaptureGuide* const guide = session.guide();
  const int views = guide ? guide->views() : 0;
  const bool enough = guide && guide->enough();
  nlohmann::ordered_json numbers{{"board", to_string(session.board())},
                                 {"views", views},
                                 {"enough", enough},
                                 {"coverage", guide ? guide->coverage() : 0}};
  if (guide) {
    numbers["missing"] = guide->wish();
    if (const cv::Mat map = guide->uncertainty(32, 24); !map.empty()) {
      double most = 0;
      cv::minMaxLoc(map, nullptr, &most);
      numbers["uncertainty_mean_px"] = cv::mean(map)[0];
      numbers["uncertainty_worst_px"] = most;
    }
  }
  write_json(a.json, numbers);
  std::printf("foresight calibrate stereo --board %s --left %s/left --right %s/right\n",
              to_string(session.board()).c_str(), a.out.c_str(), a.out.c_str());
  if (enough) return 0;
  std::fprintf(stderr, "foresight: %d views are not enough; %s\n", views,
               guide && !guide->wish().empty() ? guide->wish().c_str() : "show more views");
  return 1;
}

int run(const Arguments& a) {
  MonotonicClock clock;
  const StereoConfig config = described(a);
  CaptureSession::Options options;
  options.out = a.out;
  options.pictures = a.pictures;
  options.guide.views = a.views;
  if (!a.images.empty()) options.guide.moved_px = 0;
  CaptureSession session(parse_board(a.board), options);
  const OpenStereo opened = open_stereo(config, moving_shafts(clock.now()), clock);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = 1; });
  loop(a, *opened.cameras, session, clock);
  return report(a, session);
}

}  // namespace

void add_capture(CLI::App& calibrate, std::function<int()>& action) {
  auto* command = calibrate.add_subcommand("capture", "Take pairs of images of a board, until they are enough");
  auto a = std::make_shared<Arguments>();
  command->add_option("--board", a->board, "chessboard|charuco|apriltag|circles:COLSxROWS:SIZE_M[:EXTRA[:FAMILY]]")
      ->required();
  command->add_option("--out", a->out, "New folder for left/ and right/")->required();
  command->add_option("--pictures", a->pictures, "Folder for now.png: the newest image with points, map and advice");
  command->add_option("--rig", a->rig, "Rig file with both cameras");
  command->add_option("--left", a->left, "Device: a path, serial:..., bus:... or libcamera:...");
  command->add_option("--right", a->right, "The right camera's");
  command->add_option("--images", a->images, "Folders of numbered images instead: LEFTDIR RIGHTDIR")->expected(2);
  command->add_flag("--mock", a->mock, "The mock lab's cameras instead");
  command->add_option("--rate", a->rate, "Pairs per second")->check(CLI::Range(0.1, 1000.0));
  command->add_option("--views", a->views, "Views to take at least")->check(CLI::Range(5, 1000));
  command->add_option("--seconds", a->seconds, "Longest time")->check(CLI::PositiveNumber);
  command->add_option("--json", a->json, "File for all numbers");
  command->footer(
      "Example: foresight calibrate capture --rig configs/minerva.yaml --board charuco:8x5:0.03:0.022:DICT_5X5_100 "
      "--out set --pictures seen");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
