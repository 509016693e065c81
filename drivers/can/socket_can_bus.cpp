#include "drivers/can/socket_can_bus.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <netlink/msg.h>
#include <netlink/socket.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/clock.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/can/kernel_frame.hpp"
#include "drivers/can/link_message.hpp"

namespace foresight {
namespace {

[[noreturn]] void fail(const std::string& interface, const char* operation, int error, const std::string& cure) {
  throw RuntimeFailure("CAN interface " + in_quotes(interface) + ": " + operation + ": " + std::strerror(error) +
                           " (errno " + std::to_string(error) + ")",
                       cure);
}

std::string known_interfaces(const std::vector<CanInterface>& all) {
  if (all.empty())
    return "there is no CAN interface; connect one, or make one for tests with `modprobe vcan && ip link add dev vcan0 "
           "type vcan && ip link set vcan0 up`";
  std::string names;
  for (const CanInterface& one : all) names += (names.empty() ? "" : ", ") + one.name;
  return "choose one of: " + names;
}

CanInterface usable_interface(const std::string& name, bool fd) {
  const auto all = can_interfaces();
  const auto found = std::find_if(all.begin(), all.end(), [&](const CanInterface& one) { return one.name == name; });
  const std::string where = "CAN interface " + in_quotes(name);
  if (found == all.end())
    throw InputError(where, "find: no such CAN interface (errno 19, ENODEV)", known_interfaces(all));
  if (!found->up) throw InputError(where, "open: it is down (errno 100, ENETDOWN)", "run " + how_to_bring_up(*found));
  if (fd && !found->fd)
    throw InputError(where, "enable FD frames: it is set up for classic frames only",
                     found->kind == "vcan" ? "run `ip link set " + name + " mtu 72`"
                                           : "run `ip link set " + name + " down` and `ip link set " + name +
                                                 " up type can bitrate 1000000 dbitrate 4000000 fd on`");
  return *found;
}

template <typename Value>
bool set_option(int socket, int level, int option, const Value& value) {
  return setsockopt(socket, level, option, &value, sizeof value) == 0;
}

Duration to_duration(const timespec& t) {
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

}  // namespace

void SocketCanOptions::validate() const {
  if (receive_buffer < 4096 || receive_buffer > 1 << 30)
    throw InputError("receive_buffer", std::to_string(receive_buffer) + " bytes", "give 4096 to 1073741824");
  if (restart_delay.count() < 0)
    throw InputError("restart_delay", std::to_string(restart_delay.count()) + " ns is negative", "give 0 or more");
  if (filters.size() > CAN_RAW_FILTER_MAX)
    throw InputError("filters", std::to_string(filters.size()) + " are too many", "give 512 at most");
  for (const CanFilter& filter : filters) {
    const std::uint32_t largest = filter.extended ? CAN_EFF_MASK : CAN_SFF_MASK;
    if (filter.id > largest || filter.mask > largest)
      throw InputError("filters", "identifier or mask of a filter is out of range", "give 11 bits, or 29 if extended");
  }
}

SocketCanBus::SocketCanBus(const std::string& interface, const SocketCanOptions& options) : options_(options) {
  options_.validate();
  interface_.name = interface;
  can_ = UniqueFd(::socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  if (!can_ && (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT))
    fail(interface, "open a socket: this kernel has no CAN", errno,
         "run `modprobe can-raw`, or boot a kernel with CONFIG_CAN; without one, use the in-process bus of the "
         "simulated "
         "lab");
  if (!can_) fail(interface, "open a socket", errno, "check that this process may open network sockets");
  interface_ = usable_interface(interface, options_.fd);
  state_ = interface_.state;
  open_can();
  const std::string purpose = "CAN interface " + in_quotes(interface) + ": listen to link changes";
  link_events_ = open_link_events(purpose.c_str());
  link_fd_ = nl_socket_get_fd(link_events_.get());
  if (options_.restart_after_bus_off) restart_.emplace(interface_.index);
  if (state_ == CanBusState::bus_off) enter(CanBusState::bus_off);
}

void SocketCanBus::open_can() {
  const int fd = can_.get(), on = 1;
  set_filters();
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  if (!set_option(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors))
    fail(name(), "enable error frames (CAN_RAW_ERR_FILTER)", errno, "use a newer kernel");
  if (options_.fd && !set_option(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on))
    fail(name(), "enable FD frames (CAN_RAW_FD_FRAMES)", errno, "use a kernel of 3.6 or newer");
  // Only CAP_NET_ADMIN may exceed the system's limit; what the limit leaves is a smaller buffer and no error.
  if (!set_option(fd, SOL_SOCKET, SO_RCVBUFFORCE, options_.receive_buffer))
    set_option(fd, SOL_SOCKET, SO_RCVBUF, options_.receive_buffer);
  const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE | SOF_TIMESTAMPING_RX_HARDWARE |
                     SOF_TIMESTAMPING_RAW_HARDWARE;
  if (!set_option(fd, SOL_SOCKET, SO_TIMESTAMPING, stamps) || !set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, on))
    fail(name(), "enable receive stamps (SO_TIMESTAMPING, SO_RXQ_OVFL)", errno, "use a newer kernel");
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = interface_.index;
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    fail(name(), "bind", errno, "check with `ip -details link show " + name() + "` that it is still there");
}

void SocketCanBus::set_filters() {
  if (options_.filters.empty()) return;
  std::vector<can_filter> filters;
  // Without the two flags in the mask a filter would take 11-bit, 29-bit and remote frames for one another.
  for (const CanFilter& filter : options_.filters)
    filters.push_back({filter.id | (filter.extended ? CAN_EFF_FLAG : 0), filter.mask | CAN_EFF_FLAG});
  if (setsockopt(can_.get(), SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                 static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0)
    fail(name(), "set the filters (CAN_RAW_FILTER)", errno, "give fewer filters");
}

CanSend SocketCanBus::send(const CanFrame& frame) noexcept {
  if (!is_sendable(frame) || (frame.fd && !options_.fd)) return CanSend::invalid;
  // Some drivers (slcan) take frames in bus-off as if nothing were wrong.
  CanSend result = state() == CanBusState::bus_off || !up_ ? CanSend::bus_down : CanSend::sent;
  if (result == CanSend::sent) {
    canfd_frame out;
    const std::size_t size = to_kernel(frame, out);
    ssize_t written = -1;
    do written = write(can_.get(), &out, size);
    while (written < 0 && errno == EINTR);
    if (written < 0)
      result = errno == ENOBUFS || errno == EAGAIN    ? CanSend::full
               : errno == EINVAL || errno == EMSGSIZE ? CanSend::invalid
                                                      : CanSend::bus_down;
  }
  if (result == CanSend::sent) ++counters_.sent;
  if (result == CanSend::full || result == CanSend::bus_down) ++counters_.send_failures;
  return result;
}

std::optional<CanFrame> SocketCanBus::receive(Duration timeout) noexcept {
  const MonotonicClock clock;
  const RobotTime until = clock.now() + timeout;
  while (true) {
    if (auto frame = read_frame()) return frame;
    read_link_events();
    const RobotTime now = clock.now();
    restart_if_due(now);
    if (now >= until || !wait(restart_at_.ns != 0 ? std::min(until, restart_at_) : until)) {
      if (clock.now() >= until) return std::nullopt;
    }
  }
}

/// Until one of the sockets has something; false where the time is over.
bool SocketCanBus::wait(RobotTime until) noexcept {
  const Duration left = std::max(until - MonotonicClock().now(), Duration{0});
  const timespec limit{left.count() / 1'000'000'000, left.count() % 1'000'000'000};
  pollfd sockets[] = {{can_.get(), POLLIN, 0}, {link_fd_, POLLIN, 0}};
  return ppoll(sockets, 2, &limit, nullptr) > 0;
}

std::optional<CanFrame> SocketCanBus::read_frame() noexcept {
  canfd_frame raw;
  alignas(cmsghdr) std::array<char, 256> control;
  iovec piece{&raw, sizeof raw};
  msghdr message{};
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  while (true) {
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t got = recvmsg(can_.get(), &message, 0);
    if (got < 0) {
      if (errno == EINTR) continue;
      if (errno == ENETDOWN || errno == ENODEV || errno == ENXIO) up_ = false;
      return std::nullopt;
    }
    auto frame = from_kernel(raw, static_cast<std::size_t>(got));
    if (!frame) continue;
    frame->time = time_of(message);
    ++counters_.received;
    if (frame->error) note_error(*frame);
    return frame;
  }
}

RobotTime SocketCanBus::time_of(const msghdr& message) noexcept {
  const RobotTime now = MonotonicClock().now();
  Duration software{0}, hardware{0};
  for (const cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(part))) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t overflows = 0;
      std::memcpy(&overflows, CMSG_DATA(part), sizeof overflows);
      counters_.lost += overflows - overflows_;
      overflows_ = overflows;
    } else if (part->cmsg_type == SCM_TIMESTAMPING) {
      scm_timestamping stamps;
      std::memcpy(&stamps, CMSG_DATA(part), sizeof stamps);
      software = to_duration(stamps.ts[0]);
      hardware = to_duration(stamps.ts[2]);  // on the controller's own clock; 0 where it has none
    }
  }
  if (software.count() == 0) return now;
  const Duration real = hardware.count() != 0 ? device_clock_.to_kernel(hardware, software) : software;
  return std::min(RobotTime{(real - realtime_minus_monotonic()).count()}, now);
}

void SocketCanBus::note_error(const CanFrame& frame) noexcept {
  ++counters_.error_frames;
  if (frame.id & CAN_ERR_CRTL) {
    const std::uint8_t what = frame.data[1];
    if (what & CAN_ERR_CRTL_RX_OVERFLOW) ++counters_.lost;
    if (what & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE))
      enter(CanBusState::passive);
    else if (what & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING))
      enter(CanBusState::warning);
    else if (what & CAN_ERR_CRTL_ACTIVE)
      enter(CanBusState::active);
  }
  if (frame.id & CAN_ERR_RESTARTED) {
    if (state_ == CanBusState::bus_off) ++counters_.restarts;
    enter(CanBusState::active);
  }
  if (frame.id & CAN_ERR_BUSOFF) enter(CanBusState::bus_off);
}

void SocketCanBus::enter(CanBusState state) noexcept {
  state_ = state;
  restart_at_ = {};
  if (state == CanBusState::bus_off && options_.restart_after_bus_off)
    restart_at_ = MonotonicClock().now() + options_.restart_delay;
}

void SocketCanBus::read_link_events() noexcept {
  alignas(nlmsghdr) std::array<char, 8192> buffer;
  while (true) {
    const ssize_t got = recv(link_fd_, buffer.data(), buffer.size(), 0);
    if (got < 0) return;  // nothing more; what ENOBUFS lost is made up for by the next event or error frame
    auto left = static_cast<int>(got);
    for (auto* message = reinterpret_cast<nlmsghdr*>(buffer.data()); nlmsg_ok(message, left);
         message = nlmsg_next(message, &left)) {
      const auto link = read_link_state(*message);
      if (!link || link->index != interface_.index) continue;
      const bool was_up = std::exchange(up_, link->up && !link->gone);
      const bool was_off = state_ == CanBusState::bus_off;
      if (!was_up && up_) enter(CanBusState::active);  // opening an interface starts its controller afresh
      if (up_ && link->state && *link->state != state_) enter(*link->state);
      if (was_off && state_ != CanBusState::bus_off) ++counters_.restarts;
    }
  }
}

void SocketCanBus::restart_if_due(RobotTime now) noexcept {
  if (restart_at_.ns == 0 || now < restart_at_) return;
  restart_at_ = {};
  restart_error_ = (*restart_)();
  if (restart_error_ != 0) restart_at_ = now + std::max(options_.restart_delay, Duration(std::chrono::seconds(1)));
}

}  // namespace foresight
