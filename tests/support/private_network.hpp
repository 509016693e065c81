// A network of a test's own, so that no port is in use and nobody else listens.
#pragma once

#include <gtest/gtest.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cstring>

#include "common/unique_fd.hpp"

namespace foresight {

/// The calling thread, and those that it starts from now on, have a network with nothing but `lo`, which is up. Once it
/// is so, further calls do nothing. False: this machine does not let us (no root, no user namespaces).
inline bool enter_private_network() {
  static const bool entered = [] {
    if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
    const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq request{};
    std::strcpy(request.ifr_name, "lo");
    if (::ioctl(socket.get(), SIOCGIFFLAGS, &request) != 0) return false;
    request.ifr_flags |= IFF_UP;
    return ::ioctl(socket.get(), SIOCSIFFLAGS, &request) == 0;
  }();
  return entered;
}

class PrivateNetworkTest : public testing::Test {
 protected:
  /// Before what a derived test has among its members opens the link.
  PrivateNetworkTest() { enter_private_network(); }
  void SetUp() override {
    if (!enter_private_network()) GTEST_SKIP() << "this machine gives us no network of our own (unshare -n)";
  }
};

}  // namespace foresight
