#include "apps/synth_command.hpp"

#include <cstdio>
#include <memory>

#include "apps/command_line/picture_size.hpp"
#include "apps/replay_report/progress_bar.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

struct SynthArguments {
  std::string out;
  std::string size = "751x570";
  std::string head_path;
  bool auto_exposure = false;
  double motion_blur_ms = 0, rolling_shutter_ms = 0;
  sim::SynthOptions options;
};

struct Interrupted {};

void parse_size(const std::string& text, sim::SynthOptions& options) {
  const auto size = parse_picture_size(text);
  if (!size) throw InputError("--size", "'" + text + "' is not a size", "write it as WIDTHxHEIGHT, such as 751x570");
  options.width = (*size)[0];
  options.height = (*size)[1];
}

std::vector<Output> synth_outputs(const std::filesystem::path& out) {
  return {{out, Output::Kind::replaced_folder, {}, [](const std::string& where, const std::filesystem::path& folder) {
             require_replaceable(where, folder, sim::synth_run_form());
           }}};
}

int run(SynthArguments arguments) {
  parse_size(arguments.size, arguments.options);
  arguments.options.shutter.exposure_s = arguments.motion_blur_ms * 1e-3;
  arguments.options.shutter.readout_s = arguments.rolling_shutter_ms * 1e-3;
  if (arguments.auto_exposure) arguments.options.auto_exposure.emplace();
  if (!arguments.head_path.empty()) arguments.options.head_path = arguments.head_path;
  const std::size_t images =
      static_cast<std::size_t>(std::max(0, arguments.options.frames)) * (arguments.options.stereo ? 2 : 1);
  const auto now = [] { return std::chrono::steady_clock::now(); };
  sim::check(arguments.options);
  std::fputs("synth: lighting the lab\n", stderr);
  ProgressBar bar("synth", "images", images, now(), ProgressBar::for_stderr());
  sim::SynthSummary summary;
  try {
    summary = sim::write_synth_run(
        arguments.out, arguments.options,
        [&](int done, int) {
          if (stop_requested()) throw Interrupted();
          std::fputs(bar.update(static_cast<std::size_t>(done), now()).c_str(), stderr);
        },
        [] { poll_stop_signals(); });  // until there is something to remove, a signal ends the program at once
  } catch (const Interrupted&) {
    std::fprintf(stderr, "\nforesight: stopped by %s, nothing was written\n", stopped_by());
    return kStopped;
  }
  std::fputs(bar.finish(images, now()).c_str(), stderr);
  std::fprintf(stderr, "synth: %d polygons, %d to %d in view\n", summary.polygons, summary.fewest_polygons_in_view,
               summary.most_polygons_in_view);
  std::printf("%s\n", arguments.out.c_str());
  return 0;
}

}  // namespace

void add_synth_command(Command& app, std::function<int()>& action) {
  Command* command = app.add_subcommand("synth", "Write a synthetic run: a lab with a moving arm, and its exact truth");
  const auto arguments = std::make_shared<SynthArguments>();
  sim::SynthOptions& options = arguments->options;
  command->add_option("OUT", arguments->out, "Folder to write; an earlier synthetic run in it is replaced")
      ->writes(synth_outputs)
      ->required();
  command->add_option("--frames", options.frames, "Images per camera")->capture_default_str();
  command->add_option("--size", arguments->size, "Image size in pixels, WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--rate", options.rate, "Images per second")->capture_default_str();
  command->add_flag("--stereo", options.stereo, "Add a second camera, 65 mm to the right");
  const Option* pinhole =
      command->add_flag("!--no-distortion", options.distortion, "An ideal pinhole instead of a real lens");
  command->add_flag("--fisheye", options.fisheye, "An equidistant lens of 150 degrees")->excludes(pinhole);
  command->add_option("--seed", options.seed, "Varies wood grain, small print, noise and pose errors")
      ->capture_default_str();
  command
      ->add_option("--head-path", arguments->head_path,
                   "Path of the left camera instead of the built-in one: a file of lines "
                   "'t x y z qx qy qz qw', seconds from 0, camera to world")
      ->reads();
  command->add_option("--blur", options.sensor.blur, "Point spread of lens and demosaicing, standard deviation in px")
      ->capture_default_str();
  command->add_option("--noise", options.sensor.noise, "Standard deviation at mid grey, in 8-bit values")
      ->capture_default_str();
  command
      ->add_option("--exposure-drift", options.sensor.exposure_drift, "Share by which the exposure swings up and down")
      ->capture_default_str();
  command
      ->add_option("--exposure", options.sensor.exposure, "Factor on the light; from about 1.5 on highlights are white")
      ->capture_default_str();
  command->add_flag("--auto-exposure", arguments->auto_exposure,
                    "The exposure follows what the camera sees as a webcam's does: late, in steps, within two stops");
  command->add_option("--motion", options.motion, "Another number: the arm goes its ways in another order")
      ->capture_default_str();
  command
      ->add_option(
          "--gloss", options.gloss,
          "How strongly every material at least mirrors the lamp, such as 0.03 for varnish; moves with the eye")
      ->capture_default_str();
  command->add_flag("--still", options.still, "The arm stands still, only the cameras move");
  command->add_option("--vignetting", options.sensor.vignetting, "Share of the light that the corners lose")
      ->capture_default_str();
  command->add_option("--motion-blur", arguments->motion_blur_ms, "Exposure time in ms")->capture_default_str();
  command->add_option("--rolling-shutter", arguments->rolling_shutter_ms, "Readout time from first to last row in ms")
      ->capture_default_str();
  command
      ->add_option("--pose-error-px", options.pose_error_px,
                   "Error of the poses in trajectory.txt: root mean square displacement in the image, in pixels")
      ->capture_default_str();
  command
      ->add_option("--pose-error-s", options.pose_error_s,
                   "Time in s over which these errors stay alike; 0: each image has its own")
      ->capture_default_str();
  command->add_flag("!--no-truth", options.truth, "Leave out the true depth, node and poses of each image");
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace foresight
