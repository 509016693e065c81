// `foresight bench registration`: what the registration of a stereo pair costs, and how right it is.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct RegistrationBenchOptions {
  int pairs = 20;
  std::optional<std::filesystem::path> json;
};

/// Draws pairs of 640x480 of a head that sweeps over a room of tags, and registers them at several
/// decimations of the detector. Prints CPU-ms of a pair (median), tags found, and the pose error in
/// pixels with tags and by the encoders alone. Returns 0.
int bench_registration(const RegistrationBenchOptions& options);

}  // namespace foresight
