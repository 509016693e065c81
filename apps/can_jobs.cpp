#include "apps/can_jobs.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <iostream>
#include <memory>

#include "common/clock.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "drivers/can/can_bits.hpp"
#include "drivers/can/recording_bus.hpp"
#include "drivers/can/replay_log.hpp"
#include "drivers/can/socket_can_bus.hpp"

namespace foresight {
namespace {

std::string rate_text(int bit_rate) {
  const bool whole = bit_rate % 1000 == 0;
  return whole ? std::to_string(bit_rate / 1000) + " kbit/s" : std::to_string(bit_rate) + " bit/s";
}

bool is_usable(const CanInterface& interface) {
  return interface.up && interface.state != CanBusState::bus_off;
}

void print_interface(const CanInterface& interface) {
  std::string line = interface.name + ": " + to_string(interface.state) + ", " + interface.kind;
  if (interface.bit_rate) line += ", " + rate_text(*interface.bit_rate);
  if (interface.data_bit_rate) line += " (data " + rate_text(*interface.data_bit_rate) + ")";
  if (interface.sample_point) line += fmt::format(", sampled at {:.1f} %", *interface.sample_point * 100);
  line += interface.fd ? ", FD" : ", classic";
  if (interface.restart_ms)
    line += *interface.restart_ms > 0 ? ", restarts " + std::to_string(*interface.restart_ms) + " ms after bus-off"
                                      : ", stays bus-off";
  if (interface.transmit_errors && interface.receive_errors)
    line += ", error counters " + std::to_string(*interface.transmit_errors) + " tx " +
            std::to_string(*interface.receive_errors) + " rx";
  if (interface.bus_offs) line += ", bus-offs " + std::to_string(*interface.bus_offs);
  line += ", queue " + std::to_string(interface.transmit_queue) + ", received " + std::to_string(interface.received) +
          " (" + std::to_string(interface.receive_dropped) + " dropped), sent " + std::to_string(interface.sent) +
          " (" + std::to_string(interface.send_dropped) + " dropped)";
  std::cout << line << "\n";
  if (!interface.up) std::cout << "  run " << how_to_bring_up(interface) << "\n";
  if (interface.state == CanBusState::bus_off) std::cout << "  run " << how_to_restart(interface) << "\n";
  if (interface.up && interface.restart_ms == 0)
    std::cout << "  to leave bus-off by itself: `ip link set " << interface.name << " down` and `ip link set "
              << interface.name << " up type can restart-ms 100`\n";
}

CanFilter parse_filter(const std::string& text) {
  const std::string cure = "give ID:MASK in hex, 3 digits each, or 8 for 29-bit identifiers, such as 580:780";
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw InputError("--filter", in_quotes(text) + " has no colon", cure);
  const auto part = [&](const std::string& digits) {
    const auto parsed = parse_can_frame(digits + "#").frame;
    if (!parsed || parsed->error) throw InputError("--filter", in_quotes(digits) + " is no identifier", cure);
    return *parsed;
  };
  const CanFrame id = part(text.substr(0, colon)), mask = part(text.substr(colon + 1));
  if (id.extended != mask.extended) throw InputError("--filter", in_quotes(text) + " mixes 11 and 29 bits", cure);
  return {id.id, mask.id, id.extended};
}

void report_losses(const CanBus& bus) {
  const CanCounters counters = bus.counters();
  if (counters.lost > 0) std::cerr << "foresight: " << counters.lost << " frames were lost before they could be read\n";
}

}  // namespace

int scan_can() {
  const bool sockets = has_can_sockets();
  const auto interfaces = can_interfaces();
  bool usable = false;
  for (const CanInterface& interface : interfaces) {
    print_interface(interface);
    usable = usable || is_usable(interface);
  }
  if (!sockets)
    std::cout << "This kernel has no CAN sockets (AF_CAN): run `modprobe can-raw`, or boot a kernel with CONFIG_CAN.\n"
                 "Without one, everything but real drives works on the in-process bus of the simulated lab.\n";
  else if (interfaces.empty())
    std::cout
        << "This kernel has CAN, and no interface. Plug one in; a serial adapter (slcan) takes `slcand -o -s8 "
           "/dev/ttyACM0 can0`.\nFor tests: `modprobe vcan && ip link add dev vcan0 type vcan && ip link set vcan0 "
           "up`\n";
  return usable ? 0 : 1;
}

int dump_can(const CanDumpOptions& options) {
  SocketCanOptions socket;
  for (const std::string& filter : options.filters) socket.filters.push_back(parse_filter(filter));
  socket.fd = options.fd;
  MonotonicClock clock;
  SocketCanBus can(options.interface, socket);
  const Duration epoch = realtime_minus_monotonic();
  const auto recorded =
      options.log ? std::make_unique<RecordingBus>(can, clock, *options.log, epoch) : std::unique_ptr<RecordingBus>();
  CanBus& bus = recorded ? static_cast<CanBus&>(*recorded) : can;
  poll_stop_signals();
  const RobotTime start = clock.now();
  std::array<char, kLongestLogLine> line;
  long long seen = 0;
  while (!stop_requested() && seen < options.count.value_or(seen + 1)) {
    const Duration left = options.seconds ? start + seconds(*options.seconds) - clock.now() : Duration::max();
    if (left.count() <= 0) break;
    const auto frame = bus.receive(std::min<Duration>(left, std::chrono::milliseconds(100)));
    if (!frame) {
      if (std::fflush(stdout) != 0) break;
      continue;
    }
    ++seen;
    std::fwrite(line.data(), 1, write_log_line(Duration{frame->time.ns} + epoch, bus.name(), *frame, {}, line), stdout);
    if (std::ferror(stdout)) break;  // nobody reads any more, which the exit code tells
  }
  report_losses(can);
  if (recorded && (recorded->failed() || recorded->dropped() > 0))
    throw RuntimeFailure(options.log->string() + ": not all frames could be written (" +
                             std::to_string(recorded->dropped()) + " are missing)",
                         "write to a faster disk with room");
  if (can.state() == CanBusState::bus_off || can.state() == CanBusState::down)
    std::cerr << "foresight: " << can.name() << " is " << to_string(can.state()) << "; see `foresight can scan`\n";
  return stop_requested() ? kStopped : 0;
}

int send_can(const CanSendOptions& options) {
  const ParsedFrame parsed = parse_can_frame(options.frame);
  const std::string cure = "give 123#DEADBEEF, 123#R8 (remote), 123##1AABB (FD), 8 digits for 29-bit identifiers";
  if (!parsed.frame) throw InputError("FRAME", std::string(parsed.problem) + ": " + in_quotes(options.frame), cure);
  if (parsed.frame->error) throw InputError("FRAME", "error frames cannot be sent", cure);
  SocketCanOptions socket;
  socket.fd = parsed.frame->fd;
  SocketCanBus bus(options.interface, socket);
  switch (bus.send(*parsed.frame)) {
    case CanSend::sent: return 0;
    case CanSend::full:
      throw RuntimeFailure(bus.name() + ": send: the transmit queue is full (nobody acknowledges?)",
                           "check wiring, termination and bit rate with `foresight can scan`");
    case CanSend::bus_down:
      throw RuntimeFailure(bus.name() + ": send: the bus is " + to_string(bus.state()),
                           "run " + how_to_restart(bus.interface()));
    case CanSend::invalid: break;
  }
  throw InputError("FRAME", in_quotes(options.frame) + " is no frame for " + bus.name(), cure);
}

int replay_can(const CanReplayOptions& options) {
  // All of the log is checked before the first frame goes out.
  bool fd = false;
  for (CandumpReader check(options.file); const auto entry = check.next();) fd = fd || entry->frame.fd;
  SocketCanOptions socket;
  socket.fd = fd;
  SocketCanBus bus(options.interface, socket);
  MonotonicClock clock;
  ReplayLogOptions replay;
  replay.speed = options.speed;
  replay.gap = seconds(options.gap_ms * 1e-3);
  poll_stop_signals();
  CandumpReader log(options.file);
  const ReplayLogSummary done = replay_log(log, bus, clock, replay, stop_requested);
  std::cout << fmt::format("{} frames sent, at most {:.3f} ms late; {} failed, {} error frames left out\n", done.sent,
                           to_seconds(done.worst_delay) * 1e3, done.failed, done.error_frames)
            << std::flush;
  if (stop_requested()) return kStopped;
  if (done.failed > 0)
    throw RuntimeFailure(bus.name() + ": " + std::to_string(done.failed) + " frames could not be sent",
                         "see `foresight can scan`, or replay more slowly with --speed");
  return 0;
}

}  // namespace foresight
