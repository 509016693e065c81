#include "drivers/can/replay_log.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace foresight {
namespace {

bool wait_until(RobotTime until, CanBus& bus, Clock& clock, const std::function<bool()>& stop) {
  while (true) {
    if (stop && stop()) return false;
    const RobotTime now = clock.now();
    if (now >= until) return true;
    const RobotTime slice = std::min(until, now + std::chrono::milliseconds(100));
    clock.sleep_until(slice);
    while (bus.receive(Duration{0})) {
    }
  }
}

CanSend send_patiently(const CanFrame& frame, CanBus& bus, Clock& clock, Duration patience) {
  const RobotTime give_up = clock.now() + patience;
  CanSend result = bus.send(frame);
  while (result == CanSend::full && clock.now() < give_up) {
    clock.sleep_until(clock.now() + std::chrono::microseconds(200));
    result = bus.send(frame);
  }
  return result;
}

}  // namespace

void ReplayLogOptions::validate() const {
  if (!(speed > 0 && speed <= 1e6)) throw InputError("speed", std::to_string(speed), "give more than 0, at most 1e6");
  if (gap.count() < 0 || longest_pause.count() < 0 || patience.count() < 0)
    throw InputError("gap, longest_pause, patience", "a time is negative", "give 0 or more");
}

ReplayLogSummary replay_log(CandumpReader& log, CanBus& bus, Clock& clock, const ReplayLogOptions& options,
                            const std::function<bool()>& stop) {
  options.validate();
  ReplayLogSummary out;
  RobotTime due = clock.now();
  std::optional<Duration> before;
  while (const auto entry = log.next()) {
    Duration pause = options.gap;
    if (entry->time) pause = before ? std::max(*entry->time - *before, Duration{0}) : Duration{0};
    if (entry->time) before = entry->time;
    pause = std::min(pause, options.longest_pause);
    due = due + Duration{static_cast<std::int64_t>(static_cast<double>(pause.count()) / options.speed)};
    if (!wait_until(due, bus, clock, stop)) break;
    if (entry->frame.error) {
      ++out.error_frames;
      continue;
    }
    out.worst_delay = std::max(out.worst_delay, clock.now() - due);
    ++(send_patiently(entry->frame, bus, clock, options.patience) == CanSend::sent ? out.sent : out.failed);
  }
  return out;
}

}  // namespace foresight
