#include "apps/robot/status_view.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace foresight {
namespace {

[[gnu::format(printf, 2, 3)]] void append(std::string& out, const char* format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  out += line;
}

std::string headline(const Rig& rig, const RobotStatus& status) {
  std::string out = rig.name + ": " + to_string(status.phase);
  const bool latched = status.phase == RobotPhase::stopped;
  if (status.phase == RobotPhase::ready) out += std::string(", ") + to_string(status.gate.state);
  if (status.gate.reason != GateReason::none && (latched || status.phase == RobotPhase::ready)) {
    out += std::string(": ") + to_string(status.gate.reason);
    if (status.gate.joint >= 0) out += " (" + rig.joints[static_cast<std::size_t>(status.gate.joint)].drive.name + ")";
    if (*status.gate.detail != '\0') out += std::string(": ") + status.gate.detail;
  }
  if (status.waiting_for >= 0)
    out += ", waiting for " + rig.joints[static_cast<std::size_t>(status.waiting_for)].drive.name;
  if (*status.refused != '\0') out += std::string("; ") + status.refused;
  if (!status.bus_healthy) out += std::string("; bus: ") + status.bus_reason;
  return out;
}

}  // namespace

std::string status_text(const Rig& rig, const RobotStatus& status, const std::vector<BusLine>& buses, int selected) {
  std::string out = headline(rig, status) + "\n";
  append(out, "  commands: %llu followed, %llu dropped%s%s; speed %.0f %%\n",
         static_cast<unsigned long long>(status.gate.accepted), static_cast<unsigned long long>(status.gate.dropped),
         status.gate.last_dropped == GateReason::none ? "" : ", last: ", to_string(status.gate.last_dropped),
         100 * status.gate.speed);
  append(out, "  %-16s %10s %10s %5s %7s  %s\n", "joint", "position", "set-point", "", "age ms", "drive");
  for (std::size_t i = 0; i < rig.joints.size(); ++i) {
    const DriveFeedback& f = status.feedback[i];
    const double age_ms = f.time.ns == 0 ? 0 : std::max(0.0, 1e3 * to_seconds(status.time - f.time));
    append(out, "%c %-16s %10.4f %10.4f %-5s %7.1f  %s%s%s%s%s\n", static_cast<int>(i) == selected ? '>' : ' ',
           rig.joints[i].drive.name.c_str(), f.position, status.set_point[i].position, rig.joints[i].unit.c_str(),
           age_ms, to_string(f.state), f.homed ? "" : ", not homed", f.limit ? ", at a limit" : "",
           *f.fault != '\0' ? ": " : "", f.fault);
  }
  for (const BusLine& bus : buses)
    append(out, "  bus %s: %s, load %.0f %%, %llu sent, %llu received, %llu lost, %llu errors\n", bus.name.c_str(),
           to_string(bus.state), 100 * bus.load, static_cast<unsigned long long>(bus.counters.sent),
           static_cast<unsigned long long>(bus.counters.received),
           static_cast<unsigned long long>(bus.counters.lost + bus.counters.send_failures),
           static_cast<unsigned long long>(bus.counters.error_frames));
  append(out, "  loop: %llu cycles, %llu overruns, lateness p99 %.3f ms, worst %.3f ms\n",
         static_cast<unsigned long long>(status.loop.cycles()), static_cast<unsigned long long>(status.loop.overruns()),
         1e3 * to_seconds(status.loop.quantile(0.99)), 1e3 * to_seconds(status.loop.worst()));
  return out;
}

}  // namespace foresight
