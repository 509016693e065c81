#include "usbip_port.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <system_error>
#include <thread>

namespace foresight::usb {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4;
constexpr std::uint32_t kHighSpeed = 3;  // enum usb_device_speed
constexpr const char* kAttach = "/sys/devices/platform/vhci_hcd.0/attach";

/// All numbers big-endian.
struct Header {
  std::uint32_t command, number, device, in, endpoint;
  /// kSubmit: transfer flags, length. kUnlink: the number of the other. Answers: status, length.
  std::uint32_t first, second;
  std::uint32_t start_frame, packets, interval;
  std::array<std::uint8_t, 8> setup;
};
static_assert(sizeof(Header) == 48);

[[noreturn]] void fail(const std::string& operation, int error = errno) {
  throw std::system_error(error, std::generic_category(), operation);
}

/// False: the other end is closed.
bool read_all(int fd, void* target, std::size_t size) {
  auto* to = static_cast<std::uint8_t*>(target);
  while (size > 0) {
    const ssize_t got = recv(fd, to, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno != ECONNRESET) fail("read from the virtual host controller");
    if (got <= 0) return false;
    to += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

void write_all(int fd, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) fail("write to the virtual host controller");
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
}

bool attach(int port, int socket) {
  const UniqueFd file(open(kAttach, O_WRONLY | O_CLOEXEC));
  if (!file) fail(std::string("open ") + kAttach + " (modprobe vhci-hcd)");
  const int device = 0x10000 + port + 1;  // a bus and a device number that only messages of the kernel show
  const std::string line = std::to_string(port) + " " + std::to_string(socket) + " " + std::to_string(device) + " " +
                           std::to_string(kHighSpeed);
  return write(file.get(), line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

}  // namespace

UsbIpPort::UsbIpPort(int port) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("open a pair of sockets");
  socket_ = UniqueFd(ends[0]);
  const UniqueFd theirs(ends[1]);
  const auto until = std::chrono::steady_clock::now() + 5s;
  while (!attach(port, theirs.get())) {
    const int error = errno;
    if (error != EBUSY || std::chrono::steady_clock::now() > until)
      fail("attach to port " + std::to_string(port) + " of " + kAttach, error);
    std::this_thread::sleep_for(50ms);
  }
}

std::optional<Request> UsbIpPort::receive() {
  Header header;
  if (!read_all(fd(), &header, sizeof header)) return std::nullopt;
  Request out;
  out.number = ntohl(header.number);
  out.endpoint = static_cast<int>(ntohl(header.endpoint));
  out.in = ntohl(header.in) != 0;
  out.setup = header.setup;
  if (ntohl(header.command) == kUnlink) {
    out.takes_back = ntohl(header.first);
    return out;
  }
  if (ntohl(header.command) != kSubmit) fail("an unknown command of the virtual host controller", EPROTO);
  out.length = ntohl(header.second);
  if (out.in) return out;
  out.data.resize(out.length);
  if (!read_all(fd(), out.data.data(), out.data.size())) return std::nullopt;
  return out;
}

void UsbIpPort::send(std::uint32_t command, std::uint32_t number, std::int32_t status, std::uint32_t length,
                     std::span<const std::uint8_t> data) {
  Header header{};
  header.command = htonl(command);
  header.number = htonl(number);
  header.first = htonl(static_cast<std::uint32_t>(status));
  header.second = htonl(length);
  Bytes all(sizeof header);
  std::memcpy(all.data(), &header, sizeof header);
  all.insert(all.end(), data.begin(), data.end());
  write_all(fd(), all);
}

void UsbIpPort::answer(const Request& request, std::span<const std::uint8_t> data) {
  const auto length = request.in ? static_cast<std::uint32_t>(data.size()) : request.length;
  send(kSubmitted, request.number, 0, length, data);
}

void UsbIpPort::stall(const Request& request) {
  send(kSubmitted, request.number, -EPIPE, 0, {});
}

void UsbIpPort::answer_taken_back(const Request& request, bool waited) {
  send(kUnlinked, request.number, waited ? -ECONNRESET : 0, 0, {});
}

}  // namespace foresight::usb
