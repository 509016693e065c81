// What every command that turns a run into textures asks for, and how it opens the run.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/command_line/command_line.hpp"
#include "scene/run_folder.hpp"
#include "texture_gpu/options.hpp"

namespace foresight {

struct RunOptions {
  std::filesystem::path run;
  std::optional<std::filesystem::path> scene;  ///< instead of the run's own model
  std::optional<double> model_accuracy;        ///< metres; default: what the model states, else 0.02
  TextureOptions textures;
};

/// Adds RUN, --scene, and the options of the textures. `options` must live as long as `command`.
void add_run_options(Command& command, RunOptions& options);

/// Adds --images, of views (TextureOptions::images). `images` must live as long as `command`.
void add_images_option(Command& command, int& images);
/// Adds --accumulate (TextureOptions::accumulate). `accumulate` must live as long as `command`.
Option* add_accumulate_option(Command& command, std::optional<bool>& accumulate);

/// Reads and checks all of the run but its pixels, warns on stderr where it looks as if it were not in metres, and sets
/// options.textures.depth_tolerance by the model. Throws InputError.
RunFolder open_run(RunOptions& options);

/// Reads every image once, with a progress bar on stderr. Throws InputError for the first bad one.
void check_images(const RunFolder& run);

}  // namespace foresight
