// USB cameras that went without libcamera's hearing of it. Private to this module, and to its tests.
#pragma once

#include <filesystem>
#include <mutex>

#include "drivers/camera/libcamera_session.hpp"

namespace foresight::libcam {

/// The folders of the USB interfaces that a camera's id may mean: libcamera ends the ids of USB cameras with
/// "-PORTS:CONFIGURATION.INTERFACE-VENDOR:PRODUCT". More than one where several buses have such ports; none where the
/// camera is no USB one. `devices`: of sysfs.
std::vector<std::filesystem::path> usb_interfaces(const std::string& id,
                                                  const std::filesystem::path& devices = "/sys/bus/usb/devices");

/// Sessions of cameras that went unheard, which may not end yet. Any thread.
class VanishedSessions {
 public:
  void add(std::unique_ptr<Session> session);
  void end_those_told();  ///< that are gone() by now

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Session>> sessions_;
};
/// The process's. Never destroyed: at its end, too, they may not end.
VanishedSessions& vanished_sessions();

}  // namespace foresight::libcam
