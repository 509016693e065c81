// The CAN interfaces of this machine: what they are, their bit rate and their state, over rtnetlink.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/can_bus.hpp"
#include "drivers/can/netlink.hpp"

namespace foresight {

/// One network interface of type CAN. Optional fields are absent where its driver has no such thing (vcan, slcan).
struct CanInterface {
  std::string name;
  int index = 0;
  std::string kind;  ///< "can", "vcan", "vxcan"; as `ip -details link` says
  bool up = false;
  bool fd = false;                                     ///< takes FD frames as it is set up now
  CanBusState state = CanBusState::down;               ///< down, or the controller's; active where it has none
  std::optional<int> bit_rate, data_bit_rate;          ///< bit/s
  std::optional<double> sample_point;                  ///< 0 .. 1 of a bit
  std::optional<int> restart_ms;                       ///< 0: stays bus-off until restarted by hand
  std::optional<int> transmit_errors, receive_errors;  ///< the controller's error counters
  std::optional<std::uint32_t> bus_offs;               ///< of the controller since it was registered
  std::uint64_t received = 0, sent = 0;                ///< frames
  std::uint64_t receive_dropped = 0, send_dropped = 0;
  int transmit_queue = 0;  ///< frames
};

/// Whether this kernel has CAN sockets (it may load the module for that).
bool has_can_sockets() noexcept;

/// In the order of their index. Empty where there are none, without CAN in the kernel too. Throws
/// RuntimeFailure where rtnetlink does not answer. Blocks for the kernel's answer, 1 s at most.
std::vector<CanInterface> can_interfaces();
/// The one called `name`; nothing where there is none.
std::optional<CanInterface> find_can_interface(const std::string& name);

/// Brings a controller back from bus-off: asks its driver, or, where that cannot, takes the interface down and up.
/// One thread. What that needs is made beforehand, so that a control loop may do it.
class CanRestart {
 public:
  /// Throws RuntimeFailure where rtnetlink cannot be reached.
  explicit CanRestart(int index);

  /// Needs CAP_NET_ADMIN. 0, or an errno. Waits for the kernel, some ms, 1 s at most for each of three requests; does
  /// not allocate.
  int operator()() noexcept;

 private:
  NetlinkSocket socket_;
  NetlinkMessage restart_, down_, up_;
  std::uint32_t requests_ = 0;
};

/// What to type for an interface that is down.
std::string how_to_bring_up(const CanInterface& interface);
/// What to type to leave bus-off.
std::string how_to_restart(const CanInterface& interface);

}  // namespace foresight
