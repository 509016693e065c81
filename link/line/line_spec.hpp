// What a line does to packets, as somebody writes it down: by numbers, or by the recording of a real one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "link/line/trace.hpp"

namespace foresight {

/// From `at` on, for `lasts`; again after every `every`, where that is above 0.
struct Outage {
  Duration at{}, lasts{}, every{};
  bool loses = false;  ///< what is sent meanwhile is lost; else it waits in the line
};

/// One direction. What it has: a bottleneck (trace of chances or rates, or `bytes_per_s`), then a way that takes time
/// (trace of packets, `delay`, `jitter`). Everything at its default: packets arrive as they are sent.
struct DirectionSpec {
  Duration delay{};               ///< besides everything else, 0 .. 1 h
  Duration jitter{};              ///< added, uniform from 0 to this
  bool reorder = false;           ///< packets may overtake by jitter; a trace of packets always reorders as recorded
  double loss = 0;                ///< share of packets, 0 .. 1
  double burst = 1;               ///< packets that are lost in a row on average, from 1; see Gilbert below
  double duplicates = 0;          ///< share of packets that arrive twice, 0 .. 1
  double bytes_per_s = 0;         ///< 0: without limit
  std::size_t queue_bytes = 0;    ///< what is sent while so much waits is lost; 0: without end
  std::vector<Outage> outages{};  ///< in no order
  std::shared_ptr<const Trace> trace{};
};

/// Both directions.
struct LineSpec {
  DirectionSpec up;    ///< robot to operator
  DirectionSpec down;  ///< operator to robot
  std::uint64_t seed = 1;
};

/// Reads a line from YAML:
///
///   seed: 1
///   up:
///     trace: drive.up        # file beside this one; a CSV file tells about both directions
///     delay_ms: 20
///     jitter_ms: 3
///     reorder: true
///     loss: 0.02
///     burst: 4
///     duplicates: 0.001
///     rate_kbps: 1000
///     queue_kb: 64
///     outages: [{at_s: 3, for_s: 1, every_s: 20, loses: true}]
///   down: {delay_ms: 20}
///
/// or a bare trace, which is a line without any other delay. Throws InputError naming file, line and field.
LineSpec read_line_spec(const std::filesystem::path& file);

/// Throws InputError naming `where` and the value that is out of its range.
void check(const DirectionSpec& spec, const std::string& where);

}  // namespace foresight
