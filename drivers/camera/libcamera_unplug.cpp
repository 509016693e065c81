#include "drivers/camera/libcamera_unplug.hpp"

#include <system_error>

namespace foresight::libcam {

namespace fs = std::filesystem;

std::vector<fs::path> usb_interfaces(const std::string& id, const fs::path& devices) {
  std::vector<fs::path> out;
  const std::size_t product = id.rfind('-');
  if (product == std::string::npos || product == 0) return out;
  const std::size_t ports = id.rfind('-', product - 1);
  if (ports == std::string::npos) return out;
  const std::string ending = id.substr(ports, product - ports);  // with its '-': "1-2.3:1.0" is port 2.3 of bus 1
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(devices, none))
    if (entry.path().filename().string().ends_with(ending)) out.push_back(entry.path());
  return out;
}

void VanishedSessions::add(std::unique_ptr<Session> session) {
  const std::lock_guard lock(mutex_);
  sessions_.push_back(std::move(session));
}

void VanishedSessions::end_those_told() {
  const std::lock_guard lock(mutex_);
  std::erase_if(sessions_, [](const auto& session) { return session->gone(); });
}

VanishedSessions& vanished_sessions() {
  static auto* const sessions = new VanishedSessions;
  return *sessions;
}

}  // namespace foresight::libcam
