#include "apps/replay_command.hpp"

#include <iomanip>
#include <map>
#include <memory>
#include <sstream>

#include "apps/replay.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

/// Unlike CLI::Range it refuses "nan" too.
CLI::Validator from_to(double low, double high) {
  const auto text = [](double value) {
    std::ostringstream stream;
    stream << std::setprecision(8) << value;
    return stream.str();
  };
  const std::string range = "from " + text(low) + " to " + text(high);
  const auto check = [low, high, range](const std::string& given) {
    const auto value = parse_number(given);
    return value && *value >= low && *value <= high ? std::string()
                                                    : in_quotes(given) + " is not a number " + range + "; give one";
  };
  return CLI::Validator(check, range, "range");
}

}  // namespace

void add_replay_command(CLI::App& app, std::function<int()>& action) {
  auto* command =
      app.add_subcommand("replay", "Plays a recorded run with a delay and shows what the operator would have seen");
  auto options = std::make_shared<ReplayOptions>();
  auto memory_mb = std::make_shared<std::uint64_t>(1024);
  command
      ->add_option("RUN", options->run, "Folder with camera.yaml, rgb.txt, trajectory.txt and scene.ply or scene.yaml")
      ->required();
  command->add_option("--scene", options->scene, "Model to use instead of the run's own");
  command->add_option("--delay-frames", options->delay_frames, "Delay in images of the run (default 0)")
      ->check(from_to(0, 1000000));
  command->add_option("--delay-ms", options->delay_ms, "Delay in milliseconds; not with --delay-frames")
      ->check(from_to(0.0, 1e7));
  const std::map<std::string, ReplayPipeline> pipelines{{"core", ReplayPipeline::core},
                                                        {"thesis", ReplayPipeline::thesis}};
  command->add_option("--pipeline", options->pipeline, "Who extracts the textures: core, or thesis (the baseline)")
      ->transform(CLI::CheckedTransformer(pipelines))
      ->default_str("core");
  command
      ->add_option("--texels-per-metre", options->textures.texels_per_metre,
                   "Finest resolution of textures (default: one texel per pixel of the closest view)")
      ->check(from_to(1.0, 1e6));
  command->add_option("--max-texture", options->textures.max_texture, "Most texels along a side of a chart")
      ->check(from_to(16, 4096));
  command->add_option("--texture-memory-mb", *memory_mb, "Memory for textures, both generations")
      ->check(from_to(1, 65536))
      ->capture_default_str();
  command->add_option("--margin-px", options->textures.margin_px, "Pixels behind a silhouette that are not trusted")
      ->check(from_to(0.0, 32.0))
      ->capture_default_str();
  command
      ->add_option("--model-accuracy-m", options->model_accuracy,
                   "Largest usual error of the model (default: accuracy_m of scene.yaml, else 0.02)")
      ->check(from_to(1e-4, 1.0));
  command->add_option("--out", options->out, "Folder for predicted/*.png and contact_sheet.png");
  command->add_option("--report", options->report, "JSON file with all measurements");
  command->add_option("--html", options->html, "HTML file with pictures and plots, self-contained");
  command->add_flag("--window", options->window, "Show delayed, predicted and actual side by side");
  command->add_flag("--real-time", options->real_time, "Play by the clock and drop what comes too late");
  command->footer(
      "Pictures are RGBA; alpha 255: colour from a camera image, 128: filled hole, 64: model without colour,\n"
      "0: no model. Image times before the first delayed image arrives are left out.\n\n"
      "Example: foresight replay runs/bench --delay-ms 500 --out out --html out/report.html");
  command->callback([options, memory_mb, &action] {
    options->textures.memory_bytes = *memory_mb << 20;
    action = [options] { return replay(*options); };
  });
}

}  // namespace foresight
