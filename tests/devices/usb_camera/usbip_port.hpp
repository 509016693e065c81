// A port of the kernel's virtual USB host controller, vhci-hcd, from the device's side.
#pragma once

#include <array>
#include <optional>

#include "common/unique_fd.hpp"
#include "little_endian.hpp"

namespace foresight::usb {

/// What the host wants: a transfer, or an earlier one back.
struct Request {
  std::uint32_t number = 0;                   ///< for the answer
  std::optional<std::uint32_t> takes_back{};  ///< the number of a transfer that shall not happen any more
  int endpoint = 0;
  bool in = false;                      ///< the host reads
  std::uint32_t length = 0;             ///< bytes that the host reads at most
  std::array<std::uint8_t, 8> setup{};  ///< of endpoint 0: USB 2.0, 9.3
  Bytes data;                           ///< that the host writes
};

/// A high-speed device, plugged in from construction to destruction. The controller sends it what usbcore and drivers
/// ask for, through a socket: the kernel's Documentation/usb/usbip_protocol.rst, "USBIP_CMD_SUBMIT" and what follows.
/// One thread. Everything throws std::system_error.
class UsbIpPort {
 public:
  /// `port` 0 .. 7, which waits up to 5 s for an earlier device to be gone. Needs root, and `modprobe vhci-hcd`.
  explicit UsbIpPort(int port);

  int fd() const noexcept { return socket_.get(); }  ///< for poll(): readable where there is a request
  /// Blocks. Nothing: the controller has dropped this device.
  std::optional<Request> receive();
  void answer(const Request& request, std::span<const std::uint8_t> data = {});  ///< `data` where the host reads
  void stall(const Request& request);                           ///< the device does not know such a request
  void answer_taken_back(const Request& request, bool waited);  ///< `waited`: that transfer was not answered before

 private:
  void send(std::uint32_t command, std::uint32_t number, std::int32_t status, std::uint32_t length,
            std::span<const std::uint8_t> data);

  UniqueFd socket_;
};

}  // namespace foresight::usb
