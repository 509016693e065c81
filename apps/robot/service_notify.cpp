#include "apps/robot/service_notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "common/text.hpp"

namespace foresight {

void notify_service(const std::string& message) {
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path == nullptr || (path[0] != '/' && path[0] != '@') || std::strlen(path) >= sizeof address.sun_path) return;
  std::memcpy(address.sun_path, path, std::strlen(path));
  if (path[0] == '@') address.sun_path[0] = '\0';  // an abstract socket
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return;
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  // Whether systemd listens is not ours to judge.
  (void)sendto(fd, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&address),
               size);
  close(fd);
}

std::optional<Duration> service_watchdog_period() {
  const char* text = std::getenv("WATCHDOG_USEC");
  const auto us = text == nullptr ? std::nullopt : parse_integer(text);
  if (!us || *us <= 0 || *us > 86'400'000'000) return std::nullopt;
  return Duration{*us * 500};
}

bool LoopLife::goes_on(RobotTime now, const RobotStatus& status) noexcept {
  const bool sets_up = status.phase == RobotPhase::setting_up && now - status.time <= kSetUpWithin;
  return std::exchange(cycles_, status.loop.cycles()) != status.loop.cycles() || sets_up;
}

}  // namespace foresight
