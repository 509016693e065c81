// A CAN bus of the Linux kernel (SocketCAN): any controller with a kernel driver, slcan, vcan.
#pragma once

#include <array>
#include <vector>

#include "common/unique_fd.hpp"
#include "drivers/can/can_bus.hpp"
#include "drivers/can/can_interfaces.hpp"
#include "drivers/can/receive_time.hpp"

struct canfd_frame;
struct msghdr;

namespace foresight {

/// Lets a frame pass where (frame id & mask) == (id & mask). The kernel applies it.
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  bool extended = false;  ///< of 29-bit frames; else of 11-bit frames
};

struct SocketCanOptions {
  bool fd = false;                 ///< FD frames too; the interface must be set up for them
  std::vector<CanFilter> filters;  ///< any of them; empty: all frames. Error frames always pass
  /// Frames are up to 1 ms late in a busy system and a full bus brings 20 a millisecond; the kernel
  /// takes about 700 bytes per frame.
  int receive_buffer = 1 << 20;
  /// Restart the controller after bus-off, `restart_delay` later, from within receive(). That
  /// takes CAP_NET_ADMIN and may block for some ms: where the interface's own restart-ms can be set, that is better.
  bool restart_after_bus_off = false;
  Duration restart_delay = std::chrono::milliseconds(100);

  /// Throws InputError.
  void validate() const;
};

/// One thread. receive() keeps state() true: it sees error frames and the link's going up and
/// down. Receive times are the controller's where it stamps, else the kernel's.
class SocketCanBus final : public CanBus {
 public:
  /// Opens `interface`. Throws InputError where it does not exist, is down or has no FD, and RuntimeFailure
  /// where the kernel has no CAN or refuses; with what to type.
  explicit SocketCanBus(const std::string& interface, const SocketCanOptions& options = {});

  const std::string& name() const noexcept override { return interface_.name; }
  CanSend send(const CanFrame& frame) noexcept override;
  std::optional<CanFrame> receive(Duration timeout) noexcept override;
  CanBusState state() const noexcept override { return up_ ? state_ : CanBusState::down; }
  CanCounters counters() const noexcept override { return counters_; }

  /// As it was when opened.
  const CanInterface& interface() const noexcept { return interface_; }
  /// errno of the last attempt to restart; 0: it worked, or none yet. EPERM: see how_to_restart().
  int restart_error() const noexcept { return restart_error_; }

 private:
  void open_can();
  void set_filters();
  bool wait(RobotTime until) noexcept;
  void read_link_events() noexcept;
  std::optional<CanFrame> read_frame() noexcept;
  RobotTime time_of(const msghdr& message) noexcept;
  void note_error(const CanFrame& frame) noexcept;
  void enter(CanBusState state) noexcept;
  void restart_if_due(RobotTime now) noexcept;

  CanInterface interface_;
  SocketCanOptions options_;
  UniqueFd can_;
  NetlinkSocket link_events_;
  int link_fd_ = -1;                   // of link_events_
  std::optional<CanRestart> restart_;  // where it may restart
  CanBusState state_;
  bool up_ = true;
  CanCounters counters_;
  std::uint32_t overflows_ = 0;  // the socket's count of frames that it had no room for; wraps
  DeviceClockOffset device_clock_;
  RobotTime restart_at_;  // 0: not planned
  int restart_error_ = 0;
};

}  // namespace foresight
