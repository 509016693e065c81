#include "apps/robot/status_view.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "operators/who_stopped.hpp"

namespace foresight {
namespace {

std::string headline(const Rig& rig, const RobotStatus& status, const std::string& line_stopper) {
  const std::vector<JointWords> joints = rig.joint_words();
  const RobotWords words = describe(status, joints);
  std::string out = rig.name + ": " + name_and_who(words.name, status, line_stopper);
  if (*status.refused != '\0') out += std::string("; ") + status.refused;
  if (!status.bus_healthy) out += std::string("; bus: ") + status.bus_reason;
  out += "\n";
  if (const std::string held = hold_text(status.gate.hold, joints, status.time); !held.empty())
    out += "  " + held + "\n";
  if (!words.cure.empty()) out += "  next: " + words.cure + "\n";
  return out;
}

/// Of the column that holds the longest one.
std::size_t width_of_names(const Rig& rig) {
  std::size_t out = 16;
  for (const RigJoint& joint : rig.joints) out = std::max(out, joint.drive.name.size());
  return out;
}

}  // namespace

std::string status_text(const Rig& rig, const RobotStatus& status, const std::vector<BusLine>& buses, int selected,
                        const std::string& line_stopper) {
  std::string out = headline(rig, status, line_stopper);
  out += fmt::format("  commands: {} followed, {} dropped{}{}; speed {:.0f} %\n", status.gate.accepted,
                     status.gate.dropped, status.gate.last_dropped == GateReason::none ? "" : ", last: ",
                     to_string(status.gate.last_dropped), 100 * status.gate.speed);
  const std::size_t names = width_of_names(rig);
  out += fmt::format("  {:<{}} {:>10} {:>10} {:>5} {:>7}  {}\n", "joint", names, "position", "set-point", "", "age ms",
                     "drive");
  for (std::size_t i = 0; i < rig.joints.size(); ++i) {
    const DriveFeedback& f = status.feedback[i];
    const double age_ms = f.time.ns == 0 ? 0 : std::max(0.0, 1e3 * to_seconds(status.time - f.time));
    out +=
        fmt::format("{} {:<{}} {:10.4f} {:10.4f} {:<5} {:7.1f}  {}{}{}{}{}\n",
                    static_cast<int>(i) == selected ? '>' : ' ', rig.joints[i].drive.name, names, f.position,
                    status.set_point[i].position, rig.joints[i].unit, age_ms, to_string(f.state),
                    f.homed ? "" : ", not homed", f.limit ? ", at a limit" : "", *f.fault != '\0' ? ": " : "", f.fault);
  }
  for (const BusLine& bus : buses)
    out += fmt::format("  bus {}: {}, load {:.0f} %, {} sent, {} received, {} lost, {} errors\n", bus.name,
                       to_string(bus.state), 100 * bus.load, bus.counters.sent, bus.counters.received,
                       bus.counters.lost + bus.counters.send_failures, bus.counters.error_frames);
  out += fmt::format("  loop: {} cycles, {} overruns, lateness p99 {:.3f} ms, worst {:.3f} ms\n", status.loop.cycles(),
                     status.loop.overruns(), 1e3 * to_seconds(status.loop.quantile(0.99)),
                     1e3 * to_seconds(status.loop.worst()));
  return out;
}

}  // namespace foresight
