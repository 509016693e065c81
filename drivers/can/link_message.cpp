#include "drivers/can/link_message.hpp"

#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <netlink/attr.h>
#include <netlink/msg.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace foresight {
namespace {

constexpr int kLinkHeader = sizeof(ifinfomsg);

const ifinfomsg* can_link(const nlmsghdr& message) {
  if (message.nlmsg_type != RTM_NEWLINK && message.nlmsg_type != RTM_DELLINK) return nullptr;
  if (!nlmsg_valid_hdr(&message, kLinkHeader)) return nullptr;
  const auto* info = static_cast<const ifinfomsg*>(nlmsg_data(&message));
  return info->ifi_type == ARPHRD_CAN ? info : nullptr;
}

// Both do without a parsed table of attributes, which libnl's accessors of links would allocate; and these leave out
// the counters of the controller.
const nlattr* of_link(const nlmsghdr& message, int type) {
  return nlmsg_find_attr(const_cast<nlmsghdr*>(&message), kLinkHeader, type);
}
const nlattr* inside(const nlattr* outer, int type) {
  if (outer == nullptr) return nullptr;
  return nla_find(static_cast<const nlattr*>(nla_data(outer)), nla_len(outer), type);
}

/// A value that a newer kernel may have made longer, or an older one shorter.
template <typename Value>
std::optional<Value> value_of(const nlattr* attribute) {
  if (attribute == nullptr) return std::nullopt;
  Value out{};
  nla_memcpy(&out, attribute, sizeof out);
  return out;
}

std::string text_of(const nlattr* attribute) {
  if (attribute == nullptr) return {};
  const auto* text = static_cast<const char*>(nla_data(attribute));
  return {text, strnlen(text, static_cast<std::size_t>(nla_len(attribute)))};
}

std::optional<CanBusState> to_state(std::optional<std::uint32_t> kernel) {
  if (!kernel) return std::nullopt;
  switch (*kernel) {
    case CAN_STATE_ERROR_ACTIVE: return CanBusState::active;
    case CAN_STATE_ERROR_WARNING: return CanBusState::warning;
    case CAN_STATE_ERROR_PASSIVE: return CanBusState::passive;
    case CAN_STATE_BUS_OFF: return CanBusState::bus_off;
    default: return std::nullopt;  // stopped or asleep: what the link's flags say already
  }
}

void read_controller(const nlattr* data, CanInterface& out) {
  // 0: never set; all ones: set, but not by the kernel (slcand).
  const auto timing = value_of<can_bittiming>(inside(data, IFLA_CAN_BITTIMING));
  if (timing && timing->bitrate != 0 && timing->bitrate != ~0u) {
    out.bit_rate = static_cast<int>(timing->bitrate);
    out.sample_point = timing->sample_point * 1e-3;
  }
  const auto fast = value_of<can_bittiming>(inside(data, IFLA_CAN_DATA_BITTIMING));
  if (fast && fast->bitrate > 0) out.data_bit_rate = static_cast<int>(fast->bitrate);
  if (const auto state = value_of<std::uint32_t>(inside(data, IFLA_CAN_STATE)))
    out.state = to_state(state).value_or(CanBusState::down);
  if (const auto ms = value_of<std::uint32_t>(inside(data, IFLA_CAN_RESTART_MS)))
    out.restart_ms = static_cast<int>(*ms);
  if (const auto errors = value_of<can_berr_counter>(inside(data, IFLA_CAN_BERR_COUNTER))) {
    out.transmit_errors = errors->txerr;
    out.receive_errors = errors->rxerr;
  }
}

}  // namespace

std::optional<LinkState> read_link_state(const nlmsghdr& message) noexcept {
  const ifinfomsg* info = can_link(message);
  if (info == nullptr) return std::nullopt;
  const nlattr* data = inside(of_link(message, IFLA_LINKINFO), IFLA_INFO_DATA);
  return LinkState{info->ifi_index, message.nlmsg_type == RTM_DELLINK, (info->ifi_flags & IFF_UP) != 0,
                   to_state(value_of<std::uint32_t>(inside(data, IFLA_CAN_STATE)))};
}

std::optional<CanInterface> read_can_interface(const nlmsghdr& message) {
  const ifinfomsg* info = can_link(message);
  if (info == nullptr || message.nlmsg_type != RTM_NEWLINK) return std::nullopt;
  CanInterface out;
  out.index = info->ifi_index;
  out.up = (info->ifi_flags & IFF_UP) != 0;
  out.state = CanBusState::active;
  out.name = text_of(of_link(message, IFLA_IFNAME));
  out.fd = value_of<std::uint32_t>(of_link(message, IFLA_MTU)).value_or(0) >= CANFD_MTU;
  out.transmit_queue = static_cast<int>(value_of<std::uint32_t>(of_link(message, IFLA_TXQLEN)).value_or(0));
  const nlattr* kind = of_link(message, IFLA_LINKINFO);
  out.kind = text_of(inside(kind, IFLA_INFO_KIND));
  read_controller(inside(kind, IFLA_INFO_DATA), out);
  const nlattr* counters = inside(kind, IFLA_INFO_XSTATS);
  if (counters != nullptr && nla_len(counters) >= static_cast<int>(sizeof(can_device_stats)))
    out.bus_offs = value_of<can_device_stats>(counters)->bus_off;
  if (const auto stats = value_of<rtnl_link_stats64>(of_link(message, IFLA_STATS64))) {
    out.received = stats->rx_packets;
    out.sent = stats->tx_packets;
    out.receive_dropped = stats->rx_dropped + stats->rx_over_errors;
    out.send_dropped = stats->tx_dropped;
  }
  if (!out.up) out.state = CanBusState::down;
  return out;
}

NetlinkMessage restart_message(int index) {
  NetlinkMessage message(nlmsg_alloc_simple(RTM_NEWLINK, NLM_F_REQUEST | NLM_F_ACK));
  nl_msg* const m = message.get();
  ifinfomsg link{};
  link.ifi_index = index;
  nlattr *info = nullptr, *data = nullptr;
  const bool written =
      m != nullptr && nlmsg_append(m, &link, sizeof link, NLMSG_ALIGNTO) == 0 &&
      (info = nla_nest_start(m, IFLA_LINKINFO)) != nullptr && nla_put_string(m, IFLA_INFO_KIND, "can") == 0 &&
      (data = nla_nest_start(m, IFLA_INFO_DATA)) != nullptr && nla_put_u32(m, IFLA_CAN_RESTART, 1) == 0 &&
      nla_nest_end(m, data) == 0 && nla_nest_end(m, info) == 0;
  if (!written) throw std::bad_alloc();
  return message;
}

}  // namespace foresight
