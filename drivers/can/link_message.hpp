// The kernel's messages on network links (rtnetlink), as far as CAN is concerned.
#pragma once

#include <linux/netlink.h>

#include <optional>

#include "drivers/can/can_interfaces.hpp"
#include "drivers/can/netlink.hpp"

namespace foresight {

/// What a message says of a link's life.
struct LinkState {
  int index = 0;
  bool gone = false;
  bool up = false;
  std::optional<CanBusState> state;  ///< of the controller, where the message has it
};

/// Both read a message of which all nlmsg_len bytes are there, and nothing beyond them, whatever it says of itself.
/// Of an RTM_NEWLINK or RTM_DELLINK message; nothing for others and for links that are not CAN. Does not allocate:
/// control loops call it.
std::optional<LinkState> read_link_state(const nlmsghdr& message) noexcept;
/// All of an RTM_NEWLINK message.
std::optional<CanInterface> read_can_interface(const nlmsghdr& message);

/// Asks the driver of link `index` to leave bus-off: RTM_NEWLINK with IFLA_CAN_RESTART, as ip-link sends it. Written
/// here, as libnl 3.7's rtnl_link_can_restart() leaves the attribute out, and the kernel then says yes and does
/// nothing.
NetlinkMessage restart_message(int index);

}  // namespace foresight
