#include "apps/run_options.hpp"

#include <chrono>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "apps/replay_report/progress_bar.hpp"
#include "common/text.hpp"
#include "scene/run_units.hpp"

namespace foresight {

void add_run_options(Command& command, RunOptions& options) {
  command
      .add_option("RUN", options.run, "Folder with camera.yaml, rgb.txt, trajectory.txt and scene.ply or scene.yaml")
      ->reads()
      ->required();
  command.add_option("--scene", options.scene, "Model to use instead of the run's own")->reads();
  command
      .add_option("--texels-per-metre", options.textures.texels_per_metre,
                  "Finest resolution of textures (default: one texel per pixel of the closest view)")
      ->check(from_to(1.0, 1e6));
  command.add_option("--max-texture", options.textures.max_texture, "Most texels along a side of a flat polygon")
      ->check(from_to(16, 4096));
  command
      .add_number(
          "--texture-memory-mb", [&options](std::uint64_t mb) { options.textures.memory_bytes = mb << 20; },
          "Memory for textures, both generations")
      ->check(from_to(1, 65536))
      ->default_str(std::to_string(options.textures.memory_bytes >> 20));
  command
      .add_option("--margin-px", options.textures.margin_px,
                  "Pixels behind a silhouette that are not trusted, besides the outermost one before it")
      ->check(from_to(0.0, 32.0))
      ->capture_default_str();
  command.add_flag(
      "!--no-shadows", options.textures.shadows,
      "Leave shadows of what moves in the textures, where they were; else they are drawn where they fall, once "
      "it is known where the lamp is");
  command.add_flag("!--no-exposure", options.textures.even_exposure,
                   "Take images as bright as they are: their exposures and what the lens takes away towards the rim "
                   "are not evened out");
  command
      .add_option("--model-accuracy-m", options.model_accuracy,
                  "Largest usual error of the model (default: accuracy_m of scene.yaml, else 0.02)")
      ->check(from_to(1e-4, 1.0));
}

Option* add_accumulate_option(Command& command, std::optional<bool>& accumulate) {
  return command.add_flag(
      "--accumulate", accumulate,
      "Show the newest image as a mean over those before it, as far as these agree: less of the sensor's "
      "noise, and finer edges");
}

void add_images_option(Command& command, int& images) {
  command
      .add_option("--images", images,
                  "Images that views look up directly: 1: the newest; more: also older ones, and the right camera's, "
                  "where they were taken from a side that is more like the eye's; 0: textures alone")
      ->check(from_to(0, 16))
      ->capture_default_str();
}

RunFolder open_run(RunOptions& options) {
  RunFolder run = RunFolder::open(options.run, {.scene = options.scene});
  if (const auto doubt = doubt_of_units(run))
    std::cerr << "warning: " << options.run.string() << ": " << *doubt << "\n";
  options.textures.depth_tolerance =
      options.model_accuracy.value_or(run.scene()->accuracy().value_or(options.textures.depth_tolerance));
  return run;
}

void check_images(const RunFolder& run) {
  const auto now = [] { return std::chrono::steady_clock::now(); };
  ProgressBar bar("check", "images", run.frames().size(), now(), ProgressBar::for_stderr());
  check_run_images(run, [&](std::size_t done, std::size_t) { std::cerr << bar.update(done, now()) << std::flush; });
  std::cerr << bar.finish(run.frames().size(), now());
}

}  // namespace foresight
