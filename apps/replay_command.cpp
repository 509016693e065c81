#include "apps/replay_command.hpp"

#include <map>
#include <memory>

#include "apps/replay.hpp"

namespace foresight {
void add_replay_command(Command& app, std::function<int()>& action) {
  auto* command =
      app.add_subcommand("replay", "Plays a recorded run with a delay and shows what the operator would have seen");
  auto options = std::make_shared<ReplayOptions>();
  add_run_options(*command, *options);
  command->add_option("--delay-frames", options->delay_frames, "Delay in images of the run (default 0)")
      ->check(from_to(0, 1000000));
  command->add_option("--delay-ms", options->delay_ms, "Delay in milliseconds; not with --delay-frames")
      ->check(from_to(0.0, 1e7));
  const Choices<ReplayPipeline> pipelines{{"core", ReplayPipeline::core}, {"thesis", ReplayPipeline::thesis}};
  command->add_choice("--pipeline", options->pipeline, pipelines,
                      "Who extracts the textures: core (default), or thesis (the baseline)");
  add_view_outputs(*command, options->outputs);
  command->add_flag("--window", options->window, "Show delayed, predicted and actual side by side");
  command->add_flag("--real-time", options->real_time, "Play by the clock and drop what comes too late");
  add_images_option(*command, options->textures.images);
  add_accumulate_option(*command, options->textures.accumulate);
  command->add_flag("!--no-projection", options->projection,
                    "Show textures alone: the newest image only when it has become textures");
  command->add_flag("!--full-extraction", options->textures.only_what_is_needed,
                    "Write all of every image to the textures; else, as views look the newest one up, what has no "
                    "colours yet and what the next image does not show as well");
  command->add_flag(
      "!--no-silhouettes", options->silhouettes,
      "Leave edges of surfaces as hard as views find them; else they are mixed as a camera's pixels mix them");
  add_level_options(*command, options->detail);
  command->add_flag(
      "--refine", options->refine,
      "Improve the poses by aligning each image that has arrived to the textured model; tags of the run's tags.txt "
      "may veto that");
  command->footer(
      "Pictures are RGBA; alpha 255: colour from a camera image, 128: filled hole, 64: model without colour,\n"
      "0: no model. Image times before the first delayed image arrives are left out.\n\n"
      "Example: foresight replay runs/bench --delay-ms 500 --out out --html out/report.html");
  command->callback([options, &action] { action = [options] { return replay(*options); }; });
}

}  // namespace foresight
