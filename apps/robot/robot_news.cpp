#include "apps/robot/robot_news.hpp"

#include <fmt/chrono.h>

#include <utility>

#include "operators/who_stopped.hpp"

namespace foresight {
namespace {

std::string utc_text(std::chrono::system_clock::time_point at) {
  const auto ms = std::chrono::floor<std::chrono::milliseconds>(at);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(ms)),
                     ms.time_since_epoch().count() % 1000);
}

}  // namespace

RobotNews::Doing RobotNews::doing(const RobotStatus& status, const std::string& line_stopper) {
  const GateStatus& gate = status.gate;
  Doing out{status.phase, GateReason::none, -1, gate.operator_id, who_stopped(status, line_stopper)};
  const bool has_reason =
      status.phase == RobotPhase::stopped || (status.phase == RobotPhase::ready && gate.state != GateState::following);
  if (has_reason) out.reason = gate.reason, out.joint = gate.joint;
  return out;
}

std::string RobotNews::of(const RobotStatus& status, std::chrono::system_clock::time_point now,
                          const std::string& line_stopper) {
  const Doing doing = RobotNews::doing(status, line_stopper);
  if (std::exchange(last_, doing) == doing) return "";
  std::string out = utc_text(now) + ": " + name_and_who(describe(status, joints_).name, status, line_stopper);
  if (const auto who = names_.find(doing.operator_id); who != names_.end()) out += "; " + who->second + " is in charge";
  return out;
}

}  // namespace foresight
