// `foresight bench seat`: a seat over a bad line for long, with faults on both sides, in stepped time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

struct SeatBenchOptions {
  std::filesystem::path rig;
  std::filesystem::path line;  ///< a line or a recorded trace (docs/line.md); "": none
  double seconds = 1800;       ///< of motion
  double delay_ms = 20;        ///< each way, besides
  double image_hz = 2;         ///< of the mock cameras
  double pictures_hz = 5;
  unsigned seed = 1;
  std::string fault;  ///< only those with this in their names
  std::optional<std::filesystem::path> json;
};

/// Every half minute or so something fails at the robot's side or at the operator's: see Fault in seat_faults.hpp.
/// Prints each fault and what the display said of it, and what memory the program holds. Returns 1 where a set-point
/// left its joint's range, speed or acceleration, the robot moved with nobody holding the switch, the display stood
/// still, a fault was not named, or memory grew by more than 10 MB after the fifth minute. Throws InputError (no fault
/// of such a name), and what try_seat() does.
int bench_seat(const SeatBenchOptions& options);

}  // namespace foresight
