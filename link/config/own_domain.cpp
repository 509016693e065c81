#include "link/config/own_domain.hpp"

#include <fmt/core.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "common/error.hpp"

namespace foresight::link {
namespace {

/// An abstract socket (unix(7)): its name is of the network namespace, as ports are, and goes with who has it.
bool hold(const UniqueFd& socket, int domain) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = fmt::format("foresight/domain/{}", domain);
  std::ranges::copy(name, address.sun_path + 1);  // behind a zero
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), length) == 0;
}

}  // namespace

OwnDomain::OwnDomain() : held_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)), number_(kFirst) {
  while (!hold(held_, number_)) {
    if (errno != EADDRINUSE)
      throw RuntimeFailure("no DDS domain of its own: " + std::generic_category().message(errno), "end other programs");
    if (++number_ == kFirst + kDomains)
      throw RuntimeFailure(fmt::format("all DDS domains from {} to {} are held by other trials", kFirst, number_ - 1),
                           "run fewer at once");
  }
}

}  // namespace foresight::link
