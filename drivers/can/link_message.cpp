#include "drivers/can/link_message.hpp"

#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>

#include <cstring>

namespace foresight {
namespace {

const ifinfomsg* can_link(const nlmsghdr& message) {
  if (message.nlmsg_type != RTM_NEWLINK && message.nlmsg_type != RTM_DELLINK) return nullptr;
  if (message.nlmsg_len < NLMSG_LENGTH(sizeof(ifinfomsg))) return nullptr;
  const auto* info = static_cast<const ifinfomsg*>(NLMSG_DATA(&message));
  return info->ifi_type == ARPHRD_CAN ? info : nullptr;
}

/// Calls visit(type, attribute) for each attribute of a level.
template <typename Visit>
void for_each(const rtattr* attribute, std::size_t bytes, Visit&& visit) {
  auto left = static_cast<int>(bytes);
  for (; RTA_OK(attribute, left); attribute = RTA_NEXT(attribute, left))
    visit(attribute->rta_type & NLA_TYPE_MASK, *attribute);
}
template <typename Visit>
void for_each_in(const rtattr& outer, Visit&& visit) {
  for_each(static_cast<const rtattr*>(RTA_DATA(&outer)), RTA_PAYLOAD(&outer), visit);
}
template <typename Visit>
void for_each_of_link(const nlmsghdr& message, Visit&& visit) {
  const auto* info = static_cast<const ifinfomsg*>(NLMSG_DATA(&message));
  for_each(IFLA_RTA(info), IFLA_PAYLOAD(&message), visit);
}

/// A value that a newer kernel may have made longer, or an older one shorter.
template <typename Value>
Value value_of(const rtattr& attribute) {
  Value out{};
  std::memcpy(&out, RTA_DATA(&attribute), std::min<std::size_t>(sizeof out, RTA_PAYLOAD(&attribute)));
  return out;
}

std::string text_of(const rtattr& attribute) {
  const auto* text = static_cast<const char*>(RTA_DATA(&attribute));
  return {text, strnlen(text, RTA_PAYLOAD(&attribute))};
}

std::optional<CanBusState> to_state(std::uint32_t kernel) {
  switch (kernel) {
    case CAN_STATE_ERROR_ACTIVE: return CanBusState::active;
    case CAN_STATE_ERROR_WARNING: return CanBusState::warning;
    case CAN_STATE_ERROR_PASSIVE: return CanBusState::passive;
    case CAN_STATE_BUS_OFF: return CanBusState::bus_off;
    default: return std::nullopt;  // stopped or asleep: what the link's flags say already
  }
}

void read_controller(unsigned type, const rtattr& value, CanInterface& out) {
  switch (type) {
    case IFLA_CAN_BITTIMING: {
      const auto timing = value_of<can_bittiming>(value);
      if (timing.bitrate == 0 || timing.bitrate == ~0u) break;  // never set; set, but not by the kernel (slcand)
      out.bit_rate = static_cast<int>(timing.bitrate);
      out.sample_point = timing.sample_point * 1e-3;
      break;
    }
    case IFLA_CAN_DATA_BITTIMING:
      if (const auto rate = value_of<can_bittiming>(value).bitrate; rate > 0)
        out.data_bit_rate = static_cast<int>(rate);
      break;
    case IFLA_CAN_STATE: out.state = to_state(value_of<std::uint32_t>(value)).value_or(CanBusState::down); break;
    case IFLA_CAN_RESTART_MS: out.restart_ms = static_cast<int>(value_of<std::uint32_t>(value)); break;
    case IFLA_CAN_BERR_COUNTER: {
      const auto errors = value_of<can_berr_counter>(value);
      out.transmit_errors = errors.txerr;
      out.receive_errors = errors.rxerr;
      break;
    }
    default: break;
  }
}

void read_link_info(const rtattr& info, CanInterface& out) {
  for_each_in(info, [&](unsigned type, const rtattr& value) {
    if (type == IFLA_INFO_KIND) out.kind = text_of(value);
    if (type == IFLA_INFO_DATA)
      for_each_in(value, [&](unsigned inner, const rtattr& field) { read_controller(inner, field, out); });
    if (type == IFLA_INFO_XSTATS && RTA_PAYLOAD(&value) >= sizeof(can_device_stats)) {
      const auto stats = value_of<can_device_stats>(value);
      out.counters = CanDeviceCounters{stats.bus_error, stats.error_warning,    stats.error_passive,
                                       stats.bus_off,   stats.arbitration_lost, stats.restarts};
    }
  });
}

}  // namespace

std::optional<LinkState> read_link_state(const nlmsghdr& message) noexcept {
  const ifinfomsg* info = can_link(message);
  if (info == nullptr) return std::nullopt;
  LinkState out{info->ifi_index, message.nlmsg_type == RTM_DELLINK, (info->ifi_flags & IFF_UP) != 0, {}};
  for_each_of_link(message, [&](unsigned type, const rtattr& outer) {
    if (type != IFLA_LINKINFO) return;
    for_each_in(outer, [&](unsigned inner, const rtattr& data) {
      if (inner != IFLA_INFO_DATA) return;
      for_each_in(data, [&](unsigned field, const rtattr& value) {
        if (field == IFLA_CAN_STATE) out.state = to_state(value_of<std::uint32_t>(value));
      });
    });
  });
  return out;
}

std::optional<CanInterface> read_can_interface(const nlmsghdr& message) {
  const ifinfomsg* info = can_link(message);
  if (info == nullptr || message.nlmsg_type != RTM_NEWLINK) return std::nullopt;
  CanInterface out;
  out.index = info->ifi_index;
  out.up = (info->ifi_flags & IFF_UP) != 0;
  out.state = CanBusState::active;
  for_each_of_link(message, [&](unsigned type, const rtattr& value) {
    if (type == IFLA_IFNAME) out.name = text_of(value);
    if (type == IFLA_MTU) out.fd = value_of<std::uint32_t>(value) >= CANFD_MTU;
    if (type == IFLA_TXQLEN) out.transmit_queue = static_cast<int>(value_of<std::uint32_t>(value));
    if (type == IFLA_LINKINFO) read_link_info(value, out);
    if (type == IFLA_STATS64) {
      const auto stats = value_of<rtnl_link_stats64>(value);
      out.received = stats.rx_packets;
      out.sent = stats.tx_packets;
      out.receive_dropped = stats.rx_dropped + stats.rx_over_errors;
      out.send_dropped = stats.tx_dropped;
    }
  });
  if (!out.up) out.state = CanBusState::down;
  return out;
}

}  // namespace foresight
