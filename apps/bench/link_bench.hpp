// `foresight bench link`: what the line itself adds to the age of a pair, on loopback, in real time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

struct LinkBenchOptions {
  double seconds = 20;
  std::string size = "1280x720";
  double rate_hz = 30;
  std::string coding = "jpeg";  ///< or h264: LinkCoding
  int quality = 85;             ///< of JPEG
  int domain = 201;             ///< not that of a line that may be running
  bool secured = false;         ///< with DDS Security, with keys made for it
  std::optional<std::filesystem::path> json;
};

/// Two processes: one codes pairs of noisy pictures and sends them as a robot does, the other receives, checks and
/// decodes them. Prints what the line adds: from the coded pair to the checked message (h264: to the last piece) in the
/// other program's hand, copies and codec of the message included, the pictures' coder not; beside that losses, the
/// coder's time, and the growth of age and memory. Returns 1 where p50 is more than 1 ms, p99 more than 5 ms, or a pair
/// was lost. Throws InputError (size), RuntimeFailure (the link cannot be opened).
int bench_link(const LinkBenchOptions& options);

}  // namespace foresight
