// `foresight bench shadow`: how wrong views are in the shadows of what moves.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace foresight {

struct ShadowBenchOptions {
  std::vector<std::filesystem::path> runs;  ///< synthetic ones, with truth
  double delay_ms = 500;
  std::optional<std::filesystem::path> json;
};

/// Replays each run with shadows foretold and without. What counts is told by the lab's own lamp and the run's truth:
/// not by the lamp that was found. Returns the exit code. Throws InputError and RuntimeFailure.
int bench_shadow(const ShadowBenchOptions& options);

}  // namespace foresight
