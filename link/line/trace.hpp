// Recorded lines: what a real one did with packets, read from files.
//
//   mahimahi's packet-delivery trace   one integer a line: a millisecond at which up to 1,500 bytes may cross
//                                      (Netravali et al., "Mahimahi", USENIX ATC 2015); its last number is the period
//   time_s,up_delay_ms,up_loss,        what became of a packet that was sent then, in either direction
//     down_delay_ms,down_loss
//   time_s,up_kbps,down_kbps           how much the line carried from then on
//
// All repeat from their end. "Up" is the way from the robot to the operator.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <variant>
#include <vector>

#include "common/time.hpp"

namespace foresight {

/// Chances to cross, each for kChanceBytes; one at which nobody waits is lost.
struct DeliveryTrace {
  std::vector<std::uint32_t> at_ms;  ///< never decreasing, the last one is the period
};
inline constexpr std::size_t kChanceBytes = 1500;
/// Rates are 0 or within these. On the slowest line a packet takes hours already: less is a mistake.
inline constexpr double kLowestRate_kbps = 1e-3, kHighestRate_kbps = 1e9;
inline constexpr Duration kShortestPeriod = std::chrono::milliseconds(1);  ///< of a trace

/// The fate of packets by the instant at which they are sent; between two rows that of the earlier.
struct PacketTrace {
  std::vector<Duration> at;     ///< from 0, increasing
  std::vector<Duration> delay;  ///< one way
  std::vector<bool> lost;
  Duration period{};
};

/// Bytes per second from each instant on.
struct RateTrace {
  std::vector<Duration> at;  ///< from 0, increasing
  std::vector<double> bytes_per_s;
  Duration period{};
};

using Trace = std::variant<DeliveryTrace, PacketTrace, RateTrace>;

/// Both directions; one that the file does not tell about is absent.
struct LineTraces {
  std::shared_ptr<const Trace> up, down;
};

/// Reads any of the three forms; a mahimahi file gives `up`. Throws InputError naming file and line: empty, not sorted,
/// other columns, a field that is no such number, a rate out of range, a line that never carries anything.
LineTraces read_line_traces(const std::filesystem::path& file);

/// After how long it repeats.
Duration period_of(const Trace& trace);

}  // namespace foresight
