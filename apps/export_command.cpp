#include "apps/export_command.hpp"

#include <memory>

#include "apps/export.hpp"

namespace foresight {

void add_export_command(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("export", "Writes the model of a run with its textures as a glTF 2.0 file");
  auto options = std::make_shared<ExportOptions>();
  add_run_options(*command, *options);
  command->add_option("--out", options->out, "FILE.glb, or FILE.gltf with FILE.bin and FILE.png beside it")
      ->writes(export_outputs)
      ->required();
  command->add_option("--until-frame", options->until_frame, "Last image to use, counted from 0 (default: all)")
      ->check(from_to(0, 1000000));
  command->add_option("--max-atlas", options->max_atlas, "Most pixels along a side of the picture of all textures")
      ->check(from_to(64, 16384))
      ->capture_default_str();
  command->footer(
      "Nodes stand where they stood at the last image used, and colours are at its exposure; holes are filled.\n\n"
      "Example: foresight export runs/bench --out bench.glb");
  command->callback([options, &action] { action = [options] { return export_model(*options); }; });
}

}  // namespace foresight
