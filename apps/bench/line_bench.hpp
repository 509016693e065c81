// `foresight bench line`: what a line makes of the images' age and quality.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

struct LineBenchOptions {
  std::optional<std::filesystem::path> trace, trace_down;  ///< recorded lines (link/line/trace.hpp)
  std::optional<std::filesystem::path> line;               ///< or a whole line (link/line/line_spec.hpp)
  double delay_ms = 20;                                    ///< each way, besides a trace
  double loss = 0, burst = 1;                              ///< both ways, besides a trace
  double seconds = 60;
  std::string size = "640x480";  ///< of one eye's picture
  std::string coding = "h264";   ///< or jpeg
  int pictures = 60;             ///< pairs that are rendered; they play forth and back
  unsigned seed = 1;             ///< of losses
  std::optional<std::filesystem::path> json;
};

/// Prints, and writes to `json`, in stepped time (link/send_control/line_trial.hpp):
///   age_p50_ms, age_p95_ms     nearest rank, of each millisecond after the first picture: age of the newest one less
///                              that of a small packet on the idle line. Without the gaps of trace and outages: times
///                              of 1 s and more in which nothing crosses. -1 without pictures outside of them
///   age_all_p95_ms             with the gaps
///   age_worst_minute_p95_ms    age_p95_ms of the worst minute, of one each half minute; -1 in shorter runs
///   gaps, gaps_s               how many there were, and how much time they take
///   pairs_per_s, bytes_per_s   decoded and newest; sent by the robot's side without network headers
///   psnr_db, psnr_p5_db        of luma against the source, mean and nearest rank over the pairs; -1 without pairs
///   worst_recovery_ms          after the gaps, from when the line could have carried 30 kB; 0 without gaps
///   damaged, early_hand_overs  pictures other than the encoder's; hand-overs with more unacknowledged bytes than were
///                              acknowledged within 200 ms: both 0
///   encode_ms, decode_ms       CPU time of a pair, median; -1 without pairs
/// Returns 1 where a damaged picture was shown, nothing was shown at all, or a hand-over was early, else 0. Throws
/// InputError: a trace or line that cannot be read, a size that is none.
int bench_line(const LineBenchOptions& options);

}  // namespace foresight
