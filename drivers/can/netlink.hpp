// A socket to the kernel's rtnetlink, and its messages, owned.
#pragma once

#include <memory>

struct nl_msg;
struct nl_sock;

namespace foresight {

struct NetlinkDeleter {
  void operator()(nl_sock* socket) const noexcept;
  void operator()(nl_msg* message) const noexcept;
};
using NetlinkSocket = std::unique_ptr<nl_sock, NetlinkDeleter>;
using NetlinkMessage = std::unique_ptr<nl_msg, NetlinkDeleter>;

/// On which no answer takes longer than a second. Throws RuntimeFailure that names `purpose`.
NetlinkSocket open_route_socket(const char* purpose);
/// Brings every change of a link; reading never waits.
NetlinkSocket open_link_events(const char* purpose);

}  // namespace foresight
