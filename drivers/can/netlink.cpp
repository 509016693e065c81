#include "drivers/can/netlink.hpp"

#include <linux/rtnetlink.h>
#include <netlink/errno.h>
#include <netlink/msg.h>
#include <netlink/socket.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <string>

#include "common/error.hpp"

namespace foresight {
namespace {

void need(int error, const char* purpose) {
  if (error >= 0) return;
  throw RuntimeFailure(std::string(purpose) + ": rtnetlink: " + nl_geterror(error),
                       "check that this process may open network sockets");
}

NetlinkSocket connected(const char* purpose) {
  NetlinkSocket socket(nl_socket_alloc());
  if (!socket) need(-NLE_NOMEM, purpose);
  need(nl_connect(socket.get(), NETLINK_ROUTE), purpose);
  return socket;
}

}  // namespace

void NetlinkDeleter::operator()(nl_sock* socket) const noexcept {
  nl_socket_free(socket);
}

void NetlinkDeleter::operator()(nl_msg* message) const noexcept {
  nlmsg_free(message);
}

NetlinkSocket open_route_socket(const char* purpose) {
  NetlinkSocket socket = connected(purpose);
  const timeval limit{1, 0};
  setsockopt(nl_socket_get_fd(socket.get()), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  return socket;
}

NetlinkSocket open_link_events(const char* purpose) {
  NetlinkSocket socket = connected(purpose);
  need(nl_socket_add_memberships(socket.get(), RTNLGRP_LINK, 0), purpose);
  need(nl_socket_set_nonblocking(socket.get()), purpose);
  return socket;
}

}  // namespace foresight
