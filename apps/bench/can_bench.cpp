#include "apps/bench/can_bench.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "drivers/can/can_bits.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/can/kernel_frame.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFrames = 10'000;
constexpr int kRounds = 31;
constexpr CanBitRates kWire{1'000'000, 0};
constexpr double kLargestBusShare = 0.05;

/// What a bus of drives carries: CiA 301 identifiers, 0 to 8 bytes that a small generator fills.
std::vector<CanFrame> bus_traffic() {
  std::vector<CanFrame> out(kFrames);
  std::uint32_t state = 1;
  for (CanFrame& frame : out) {
    const auto next = [&state] { return (state = state * 1664525 + 1013904223) >> 16; };
    frame.id = 0x80 + next() % 0x700;
    frame.size = static_cast<std::uint8_t>(next() % 9);
    for (std::size_t i = 0; i < frame.size; ++i) frame.data[i] = static_cast<std::uint8_t>(next());
  }
  return out;
}

struct Step {
  const char* name;
  bool of_a_bus;                       ///< needed for every frame while a bus is read and recorded
  std::function<std::uint64_t()> run;  ///< over all frames; returns something of each, so that nothing is left out
  std::vector<double> ns_per_frame;
};

/// The frames in all the forms that the steps take.
struct Traffic {
  std::vector<CanFrame> frames = bus_traffic();
  std::vector<canfd_frame> raw{frames.size()};
  std::vector<std::string> lines;

  Traffic() {
    std::array<char, kLongestLogLine> line;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      to_kernel(frames[i], raw[i]);
      const Duration time{1'700'000'000'000'000'000 + static_cast<std::int64_t>(i) * 50'000};
      lines.emplace_back(line.data(), write_log_line(time, "can0", frames[i], false, line) - 1);
    }
  }
};

std::vector<Step> make_steps(Traffic& traffic) {
  std::vector<Step> steps;
  steps.push_back({"encode for the kernel",
                   true,
                   [&traffic] {
                     std::uint64_t sum = 0;
                     canfd_frame out;
                     for (const CanFrame& frame : traffic.frames) sum += to_kernel(frame, out) + out.data[0];
                     return sum;
                   },
                   {}});
  steps.push_back({"decode from the kernel",
                   true,
                   [&traffic] {
                     std::uint64_t sum = 0;
                     for (const canfd_frame& raw : traffic.raw) sum += from_kernel(raw, CAN_MTU)->id;
                     return sum;
                   },
                   {}});
  steps.push_back({"bits on the wire (bus load)",
                   true,
                   [&traffic] {
                     std::uint64_t sum = 0;
                     for (const CanFrame& frame : traffic.frames)
                       sum += static_cast<std::uint64_t>(can_bits(frame).total());
                     return sum;
                   },
                   {}});
  steps.push_back({"write a log line",
                   true,
                   [&traffic] {
                     std::uint64_t sum = 0;
                     std::array<char, kLongestLogLine> line;
                     for (std::size_t i = 0; i < traffic.frames.size(); ++i)
                       sum += write_log_line(Duration{static_cast<std::int64_t>(i) * 50'000}, "can0", traffic.frames[i],
                                             false, line);
                     return sum;
                   },
                   {}});
  steps.push_back({"read a log line",
                   false,
                   [&traffic] {
                     std::uint64_t sum = 0;
                     for (const std::string& line : traffic.lines) sum += parse_log_line(line, "log")->frame.id;
                     return sum;
                   },
                   {}});
  return steps;
}

void measure(std::vector<Step>& steps) {
  volatile std::uint64_t sink = 0;
  for (int round = -1; round < kRounds; ++round) {  // one more for the caches
    for (Step& step : steps) {
      const double start = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
      sink = sink + step.run();
      if (round >= 0)
        step.ns_per_frame.push_back((cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - start) * 1e9 /
                                    static_cast<double>(kFrames));
    }
  }
}

}  // namespace

int bench_can(const CanBenchOptions& options) {
  Traffic traffic;
  std::vector<Step> steps = make_steps(traffic);
  measure(steps);
  const CanBits shortest{47, 0};  // 11-bit identifier, no data, no stuff bit: no bus brings more frames
  const double most = 1 / to_seconds(wire_time(shortest, kWire));
  Duration wire{0};
  for (const CanFrame& frame : traffic.frames) wire += wire_time(can_bits(frame), kWire);
  const double typical = static_cast<double>(kFrames) / to_seconds(wire);

  nlohmann::json all;
  double per_frame = 0;
  std::printf(
      "%zu frames, median of %d rounds, CPU time          ns per frame   frames per s   of a core on a full bus\n",
      kFrames, kRounds);
  for (Step& step : steps) {
    const double ns = median(step.ns_per_frame);
    if (step.of_a_bus) per_frame += ns;
    std::printf("%-50s %12.1f %14.0f   %10.3f %%\n", step.name, ns, 1e9 / ns, ns * most * 1e-7);
    all["steps"][step.name] = {{"ns_per_frame", ns}, {"frames_per_second", 1e9 / ns}};
  }
  const double share = per_frame * most * 1e-9;
  std::printf("%-50s %12.1f %14.0f   %10.3f %%   (limit 5 %%: %s)\n", "all that a recorded bus needs", per_frame,
              1e9 / per_frame, share * 100, share < kLargestBusShare ? "met" : "MISSED");
  std::printf("%-50s %12s %14.0f\n", "1 Mbit/s wire, shortest frames (47 bits)", "", most);
  std::printf("%-50s %12s %14.0f\n", "1 Mbit/s wire, these frames", "", typical);
  all["share_of_core_on_full_bus"] = share;
  all["wire_frames_per_second"] = {{"shortest", most}, {"these", typical}};
  write_numbers(options.json, all.dump(2));
  return share < kLargestBusShare ? 0 : 1;
}

}  // namespace foresight
