#include "drivers/can/can_interfaces.hpp"

#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "common/error.hpp"
#include "common/unique_fd.hpp"
#include "drivers/can/link_message.hpp"

namespace foresight {
namespace {

using Buffer = std::array<char, 32768>;  // a dumped link has at most that, by the kernel's own limit

/// A request on links with room for a few attributes.
struct Request {
  nlmsghdr header{};
  ifinfomsg link{};
  std::array<char, 128> attributes{};

  Request(int type, int flags) {
    header.nlmsg_len = NLMSG_LENGTH(sizeof link);
    header.nlmsg_type = static_cast<std::uint16_t>(type);
    header.nlmsg_flags = static_cast<std::uint16_t>(NLM_F_REQUEST | flags);
    link.ifi_family = AF_UNSPEC;
  }
  /// Appends an attribute and returns it; its length may be raised by appending inside it.
  rtattr* add(unsigned short type, const void* data, std::size_t size) {
    auto* attribute = reinterpret_cast<rtattr*>(reinterpret_cast<char*>(this) + NLMSG_ALIGN(header.nlmsg_len));
    attribute->rta_type = type;
    attribute->rta_len = static_cast<unsigned short>(RTA_LENGTH(size));
    if (size > 0) std::memcpy(RTA_DATA(attribute), data, size);
    header.nlmsg_len = NLMSG_ALIGN(header.nlmsg_len) + RTA_ALIGN(attribute->rta_len);
    return attribute;
  }
  void close(rtattr* outer) {
    outer->rta_len =
        static_cast<unsigned short>(reinterpret_cast<char*>(this) + header.nlmsg_len - reinterpret_cast<char*>(outer));
  }
};

/// A socket on which no answer takes longer than a second; -1 with errno where there is none.
UniqueFd open_route_socket() {
  UniqueFd socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  const timeval limit{1, 0};
  if (socket) setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  return socket;
}

/// Sends and hands every answering message to visit. 0 or an errno.
template <typename Visit>
int talk(int socket, const Request& request, Buffer& buffer, Visit&& visit) {
  if (::send(socket, &request, request.header.nlmsg_len, 0) < 0) return errno;
  while (true) {
    const ssize_t got = recv(socket, buffer.data(), buffer.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno == EAGAIN ? ETIMEDOUT : errno;
    auto left = static_cast<unsigned>(got);
    for (auto* message = reinterpret_cast<nlmsghdr*>(buffer.data()); NLMSG_OK(message, left);
         message = NLMSG_NEXT(message, left)) {
      if (message->nlmsg_type == NLMSG_DONE) return 0;
      if (message->nlmsg_type == NLMSG_ERROR) return -static_cast<const nlmsgerr*>(NLMSG_DATA(message))->error;
      visit(*message);
    }
  }
}

int change(int socket, const Request& request) noexcept {
  alignas(nlmsghdr) Buffer buffer;
  return talk(socket, request, buffer, [](const nlmsghdr&) {});
}

int set_up(int socket, int index, bool up) noexcept {
  Request request(RTM_NEWLINK, NLM_F_ACK);
  request.link.ifi_index = index;
  request.link.ifi_change = IFF_UP;
  request.link.ifi_flags = up ? IFF_UP : 0;
  return change(socket, request);
}

}  // namespace

bool has_can_sockets() noexcept {
  return static_cast<bool>(UniqueFd(::socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, 1 /* CAN_RAW */)));
}

std::vector<CanInterface> can_interfaces() {
  const UniqueFd socket = open_route_socket();
  std::vector<CanInterface> out;
  Request request(RTM_GETLINK, NLM_F_DUMP);
  const auto buffer = std::make_unique<Buffer>();
  const int error = !socket ? errno : talk(socket.get(), request, *buffer, [&](const nlmsghdr& message) {
    if (auto link = read_can_interface(message)) out.push_back(std::move(*link));
  });
  if (error != 0)
    throw RuntimeFailure(
        std::string("the list of network interfaces (rtnetlink, RTM_GETLINK) cannot be read: ") + std::strerror(error),
        "check that this process may open network sockets");
  return out;
}

std::optional<CanInterface> find_can_interface(const std::string& name) {
  for (CanInterface& interface : can_interfaces())
    if (interface.name == name) return std::move(interface);
  return std::nullopt;
}

int restart_can_interface(int index) noexcept {
  const UniqueFd socket = open_route_socket();
  if (!socket) return errno;
  Request request(RTM_NEWLINK, NLM_F_ACK);
  request.link.ifi_index = index;
  rtattr* info = request.add(IFLA_LINKINFO, nullptr, 0);
  request.add(IFLA_INFO_KIND, "can", 3);
  rtattr* data = request.add(IFLA_INFO_DATA, nullptr, 0);
  const std::uint32_t yes = 1;
  request.add(IFLA_CAN_RESTART, &yes, sizeof yes);
  request.close(data);
  request.close(info);
  const int error = change(socket.get(), request);
  if (error != EOPNOTSUPP) return error;
  // slcan cannot restart, but starts afresh when it is opened again.
  if (const int down = set_up(socket.get(), index, false); down != 0) return down;
  return set_up(socket.get(), index, true);
}

std::string how_to_bring_up(const CanInterface& interface) {
  const std::string link = "`ip link set " + interface.name;
  return interface.kind == "can" && !interface.bit_rate ? link + " up type can bitrate 1000000`" : link + " up`";
}

std::string how_to_restart(const CanInterface& interface) {
  const std::string link = "`ip link set " + interface.name;
  if (!interface.restart_ms) return link + " down` and " + link + " up`";
  return link + " type can restart`, or for good, with the interface down first, " + link +
         " up type can restart-ms 100`";
}

}  // namespace foresight
