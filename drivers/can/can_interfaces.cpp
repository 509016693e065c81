#include "drivers/can/can_interfaces.hpp"

#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netlink/errno.h>
#include <netlink/handlers.h>
#include <netlink/msg.h>
#include <netlink/netlink.h>
#include <netlink/route/link.h>
#include <netlink/route/rtnl.h>
#include <netlink/socket.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <exception>
#include <new>
#include <utility>

#include "common/error.hpp"
#include "common/unique_fd.hpp"
#include "drivers/can/link_message.hpp"

namespace foresight {
namespace {

struct Listing {
  std::vector<CanInterface> found;
  std::exception_ptr error;  // libnl is C: nothing may be thrown through it
};

int note_link(nl_msg* message, void* listing) noexcept {
  auto& out = *static_cast<Listing*>(listing);
  try {
    if (auto link = read_can_interface(*nlmsg_hdr(message))) out.found.push_back(std::move(*link));
    return NL_OK;
  } catch (...) {
    out.error = std::current_exception();
    return NL_STOP;
  }
}

/// A request to change link `index` as `fill` says, ready to be sent.
template <typename Fill>
NetlinkMessage change_request(int index, Fill&& fill) {
  struct Release {
    void operator()(rtnl_link* link) const noexcept { rtnl_link_put(link); }
  };
  const std::unique_ptr<rtnl_link, Release> link(rtnl_link_alloc()), changes(rtnl_link_alloc());
  if (!link || !changes) throw std::bad_alloc();
  rtnl_link_set_ifindex(link.get(), index);
  rtnl_link_set_ifindex(changes.get(), index);
  fill(changes.get());
  nl_msg* message = nullptr;
  if (const int error = rtnl_link_build_change_request(link.get(), changes.get(), NLM_F_ACK, &message); error < 0)
    throw RuntimeFailure(std::string("a request to restart a CAN controller: ") + nl_geterror(error),
                         "report this as a mistake in Foresight");
  return NetlinkMessage(message);
}

/// Sends a request and waits for the kernel's answer. 0 or an errno. Does not allocate.
int ask(nl_sock* socket, nl_msg* request, std::uint32_t number) noexcept {
  nlmsghdr& header = *nlmsg_hdr(request);
  header.nlmsg_flags |= NLM_F_REQUEST | NLM_F_ACK;
  header.nlmsg_seq = number;
  const int fd = nl_socket_get_fd(socket);
  if (::send(fd, &header, header.nlmsg_len, 0) < 0) return errno;
  alignas(nlmsghdr) std::array<char, 4096> buffer;
  while (true) {
    const ssize_t got = ::recv(fd, buffer.data(), buffer.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno == EAGAIN ? ETIMEDOUT : errno;
    auto left = static_cast<int>(got);
    for (auto* answer = reinterpret_cast<nlmsghdr*>(buffer.data()); nlmsg_ok(answer, left);
         answer = nlmsg_next(answer, &left))
      // An answer that came too late for an earlier request is passed over.
      if (answer->nlmsg_type == NLMSG_ERROR && answer->nlmsg_seq == number &&
          nlmsg_datalen(answer) >= static_cast<int>(sizeof(int)))
        return -static_cast<const nlmsgerr*>(nlmsg_data(answer))->error;
  }
}

}  // namespace

bool has_can_sockets() noexcept {
  return static_cast<bool>(UniqueFd(::socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, 1 /* CAN_RAW */)));
}

std::vector<CanInterface> can_interfaces() {
  const char* purpose = "the list of network interfaces (RTM_GETLINK) cannot be read";
  const NetlinkSocket socket = open_route_socket(purpose);
  Listing out;
  nl_socket_modify_cb(socket.get(), NL_CB_VALID, NL_CB_CUSTOM, note_link, &out);
  int error = nl_rtgen_request(socket.get(), RTM_GETLINK, AF_UNSPEC, NLM_F_DUMP);
  if (error >= 0) error = nl_recvmsgs_default(socket.get());
  if (out.error) std::rethrow_exception(out.error);
  if (error < 0)
    throw RuntimeFailure(std::string(purpose) + ": rtnetlink: " + nl_geterror(error),
                         "check that this process may open network sockets");
  return std::move(out.found);
}

std::optional<CanInterface> find_can_interface(const std::string& name) {
  for (CanInterface& interface : can_interfaces())
    if (interface.name == name) return std::move(interface);
  return std::nullopt;
}

CanRestart::CanRestart(int index)
    : socket_(open_route_socket("a socket to restart a CAN controller")),
      restart_(restart_message(index)),
      down_(change_request(index, [](rtnl_link* link) { rtnl_link_unset_flags(link, IFF_UP); })),
      up_(change_request(index, [](rtnl_link* link) { rtnl_link_set_flags(link, IFF_UP); })) {}

int CanRestart::operator()() noexcept {
  const int error = ask(socket_.get(), restart_.get(), ++requests_);
  if (error != EOPNOTSUPP) return error;
  // slcan cannot restart, but starts afresh when it is opened again.
  if (const int down = ask(socket_.get(), down_.get(), ++requests_); down != 0) return down;
  return ask(socket_.get(), up_.get(), ++requests_);
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
