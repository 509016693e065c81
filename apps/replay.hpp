// `foresight replay`: plays a recorded run through a texture pipeline and measures the prediction.
#pragma once

#include <optional>

#include "apps/level_options.hpp"
#include "apps/run_options.hpp"
#include "apps/view_outputs.hpp"

namespace foresight {

enum class ReplayPipeline {
  core,    ///< texture_core.hpp
  thesis,  ///< thesis_pipeline.hpp, the baseline
};

struct ReplayOptions : RunOptions {
  ReplayPipeline pipeline = ReplayPipeline::core;
  std::optional<int> delay_frames;  ///< not with delay_ms
  std::optional<double> delay_ms;   ///< not with delay_frames; without either: 0
  ViewOutputs outputs;
  bool window = false;
  bool real_time = false;
  bool projection = true;   ///< ViewSetup::newest_image; not with thesis
  bool silhouettes = true;  ///< ViewSetup::silhouettes; not with thesis
  LevelArguments detail;    ///< not with thesis
  bool refine = false;      ///< poses, from images that have arrived (replay_refinement.hpp); not with thesis
};

/// Checks all input before anything is written, then replays. Returns the exit code: 0, or 130
/// after Ctrl-C (finished frames and a valid report are left). Throws InputError and
/// RuntimeFailure.
int replay(const ReplayOptions& options);

}  // namespace foresight
