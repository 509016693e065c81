// Tells systemd how a service does (sd_notify(3)), where it asks.
#pragma once

#include <optional>
#include <string>

#include "common/time.hpp"
#include "drivers/robot/robot.hpp"

namespace foresight {

/// Sends `message` ("READY=1", "WATCHDOG=1", "STATUS=...") to the socket named in NOTIFY_SOCKET; does nothing without
/// one.
void notify_service(const std::string& message);

/// How often systemd wants to hear WATCHDOG=1 (half of WATCHDOG_USEC), if it does.
std::optional<Duration> service_watchdog_period();

/// Whether a robot's control loop does what it should: only then systemd is told that the service lives. One thread.
class LoopLife {
 public:
  /// How long drives may take to be set up: some tens of steps each, a second at most where one does not answer.
  static constexpr Duration kSetUpWithin = std::chrono::seconds(60);
  /// It made cycles since the last call, or sets up drives, between two cycles, since not too long ago.
  bool goes_on(RobotTime now, const RobotStatus& status) noexcept;

 private:
  std::uint64_t cycles_ = 0;
};

}  // namespace foresight
