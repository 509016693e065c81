#include "drivers/drive/drive.hpp"

#include <fmt/core.h>

namespace foresight {

std::string to_text(const DriveIdentity& identity) {
  std::string out;
  const auto add = [&](const char* key, std::optional<std::uint32_t> value, bool hex) {
    if (!value) return;
    out += fmt::format("{}{}: {}", out.empty() ? "" : ", ", key,
                       hex ? fmt::format("0x{:X}", *value) : std::to_string(*value));
  };
  add("vendor", identity.vendor, true);
  add("product", identity.product, true);
  add("serial", identity.serial, false);
  return out;
}

const char* to_string(DriveState state) {
  switch (state) {
    case DriveState::offline: return "offline";
    case DriveState::disabled: return "disabled";
    case DriveState::enabling: return "enabling";
    case DriveState::enabled: return "enabled";
    case DriveState::homing: return "homing";
    case DriveState::stopping: return "stopping";
    case DriveState::fault: return "fault";
  }
  return "?";
}

}  // namespace foresight
