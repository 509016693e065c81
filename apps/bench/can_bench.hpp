// `foresight bench can`: what our share of CAN costs, beside what a wire can carry.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct CanBenchOptions {
  std::optional<std::filesystem::path> json;
};

/// CPU time per frame of the codec, the log and the recorder, as medians of interleaved rounds. Prints the
/// share of a core that a full 1 Mbit/s bus needs; returns 1 where that is 5 % or more, else 0.
int bench_can(const CanBenchOptions& options);

}  // namespace foresight
