// Tells systemd how a service does (sd_notify(3)), where it asks.
#pragma once

#include <optional>
#include <string>

#include "common/time.hpp"

namespace foresight {

/// Sends `message` ("READY=1", "WATCHDOG=1", "STATUS=...") to the socket named in NOTIFY_SOCKET; does nothing without
/// one.
void notify_service(const std::string& message);

/// How often systemd wants to hear WATCHDOG=1 (half of WATCHDOG_USEC), if it does.
std::optional<Duration> service_watchdog_period();

}  // namespace foresight
