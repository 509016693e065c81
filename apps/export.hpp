// `foresight export`: the model of a run with the textures of its images, as a glTF file.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/run_options.hpp"

namespace foresight {

struct ExportOptions : RunOptions {
  std::filesystem::path out;       ///< .glb or .gltf
  std::optional<int> until_frame;  ///< last image to use, from 0; default: the run's last
  int max_atlas = 8192;            ///< px
};

/// All files that --out stands for. Throws InputError for another extension.
std::vector<Output> export_outputs(const std::filesystem::path& out);

/// Checks all input before anything is written. Returns the exit code: 0, or 130 after Ctrl-C with
/// nothing written. Throws InputError and RuntimeFailure.
int export_model(const ExportOptions& options);

}  // namespace foresight
