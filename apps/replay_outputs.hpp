// Where a replay writes to: checked before any work is done.
#pragma once

#include "apps/replay.hpp"
#include "scene/run_folder.hpp"

namespace foresight {

/// Refuses outputs that cannot be written, that are each other, or that would overwrite the run
/// (output_files.hpp). Throws InputError naming the option, the path, the reason and the cure.
void check_outputs(const ReplayOptions& options, const RunFolder& run);

}  // namespace foresight
