#include "link/dds/settings.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
#include <memory>

#include "common/error.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "link/dds/participant.hpp"

namespace foresight::link {
namespace {

// Bounds what a stranger's fragments may make Cyclone hold together: two images at their largest, and what is around.
constexpr int kMostSampleMb = 40;

// How many programs of a domain one host may have: unicast discovery asks that many ports of every peer.
constexpr int kMostPrograms = 32;

// A wire without losses, and no limit but the socket's buffer: as few and large datagrams as there may be.
constexpr const char* kLoopbackSizes = "<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>60000B</FragmentSize>";
// Datagrams that fit into a frame of Ethernet: with larger ones, one lost frame loses tens of kilobytes.
constexpr const char* kLanSizes = "<MaxMessageSize>1472B</MaxMessageSize><FragmentSize>1344B</FragmentSize>";

std::string peers_of(const LinkConfig& config) {
  std::string out;
  for (const std::string& peer : config.peers) out += fmt::format("<Peer Address=\"{}\"/>", peer);
  if (config.loopback()) out += "<Peer Address=\"127.0.0.1\"/>";
  return out.empty() ? out : "<Peers>" + out + "</Peers>";
}

/// All interfaces: is it up, with an IPv4 address?
std::vector<std::pair<std::string, bool>> interfaces() {
  std::vector<std::pair<std::string, bool>> out;
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return out;
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, &::freeifaddrs);
  for (const ifaddrs* one = first; one; one = one->ifa_next) {
    const bool usable = one->ifa_addr && one->ifa_addr->sa_family == AF_INET && (one->ifa_flags & IFF_UP);
    const auto known = std::ranges::find(out, one->ifa_name, &std::pair<std::string, bool>::first);
    if (known == out.end())
      out.emplace_back(one->ifa_name, usable);
    else
      known->second |= usable;
  }
  return out;
}

void check_peer(const LinkConfig& config, const std::string& peer) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const std::string host = peer.substr(0, peer.find(':'));  // a port may follow
  const int error = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  if (error != 0)
    throw InputError(config.where, "nobody knows the peer " + in_quotes(peer) + " (" + ::gai_strerror(error) + ")",
                     "write its address, such as 192.168.1.20");
}

}  // namespace

std::string cyclone_settings(const LinkConfig& config, int receive_buffer) {
  // Where peers are named, multicast is not needed, and often not let through.
  const bool multicast = !config.loopback() && config.peers.empty();
  return fmt::format(
      "<CycloneDDS><Domain><General>"
      "<Interfaces><NetworkInterface name=\"{}\"{}/></Interfaces><AllowMulticast>{}</AllowMulticast>{}"
      "</General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex><LeaseDuration>1s</LeaseDuration>{}</Discovery>"
      "<Internal><SocketReceiveBufferSize min=\"{}B\" max=\"{}B\"/><NackDelay>2ms</NackDelay>"
      "<MaxSampleSize>{}MB</MaxSampleSize>"
      // A writer that holds more than this would wait for its slowest reader. Of the newest sample alone it never does.
      "<Watermarks><WhcHigh>{}MB</WhcHigh><WhcHighInit>{}MB</WhcHighInit><WhcAdaptive>false</WhcAdaptive></Watermarks>"
      "</Internal></Domain></CycloneDDS>",
      config.interface, config.loopback() ? " multicast=\"false\"" : "", multicast ? "spdp" : "false",
      config.loopback() ? kLoopbackSizes : kLanSizes, kMostPrograms, peers_of(config), receive_buffer, receive_buffer,
      kMostSampleMb, 2 * kMostSampleMb, 2 * kMostSampleMb);
}

void check_network(const LinkConfig& config) {
  std::vector<std::string> names, usable;
  for (const auto& [name, good] : interfaces()) {
    names.push_back(name);
    if (good) usable.push_back(name);
  }
  if (std::ranges::find(names, config.interface) == names.end())
    throw InputError(config.where, "there is no network interface " + in_quotes(config.interface),
                     usable.empty() ? "none is up: `ip link set lo up` for this machine alone"
                                    : "set link.interface to one of " + joined(usable));
  if (std::ranges::find(usable, config.interface) == usable.end())
    throw InputError(config.where,
                     "the network interface " + in_quotes(config.interface) + " is down or has no address",
                     "type `ip link set " + config.interface + " up` and give it an IPv4 address" +
                         (usable.empty() ? "" : ", or choose one of " + joined(usable)));
  for (const std::string& peer : config.peers) check_peer(config, peer);
}

int granted_receive_buffer() {
  const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  int size = kWantedReceiveBuffer;
  socklen_t length = sizeof size;
  if (socket.get() < 0 || ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &size, length) != 0 ||
      ::getsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &size, &length) != 0)
    return 0;
  return std::min(size / 2, kWantedReceiveBuffer);  // the kernel doubles it, for its own book-keeping
}

std::string receive_buffer_trouble() {
  const int granted = granted_receive_buffer();
  if (granted >= kWantedReceiveBuffer) return "";
  return fmt::format(
      "the kernel grants receive buffers of {} kB, where images want {} kB: they will be lost, even on a good line; "
      "type "
      "`sysctl -w net.core.rmem_max={}`, and keep it in /etc/sysctl.d/60-foresight.conf",
      granted / 1000, kWantedReceiveBuffer / 1000, 2 * kWantedReceiveBuffer);
}

}  // namespace foresight::link
