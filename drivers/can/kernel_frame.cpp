#include "drivers/can/kernel_frame.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace foresight {
namespace {

// One buffer serves both: the fields of a classic frame lie where the FD frame has them.
static_assert(offsetof(can_frame, data) == offsetof(canfd_frame, data));
static_assert(offsetof(can_frame, len) == offsetof(canfd_frame, len));

bool is_fd_size(unsigned size) {
  return size <= 8 || size == 12 || size == 16 || size == 20 || size == 24 || size == 32 || size == 48 || size == 64;
}

}  // namespace

bool is_sendable(const CanFrame& frame) noexcept {
  if (frame.error || frame.id > (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK)) return false;
  if (frame.fd) return !frame.remote && is_fd_size(frame.size);
  return frame.size <= CAN_MAX_DLEN && !frame.bit_rate_switch;
}

std::size_t to_kernel(const CanFrame& frame, canfd_frame& out) noexcept {
  out.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0) | (frame.remote ? CAN_RTR_FLAG : 0);
  out.len = frame.size;
  out.flags = frame.bit_rate_switch ? CANFD_BRS : 0;
  out.__res0 = out.__res1 = 0;
  const std::size_t room = frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN;
  std::memcpy(out.data, frame.data.data(), room);
  return frame.fd ? CANFD_MTU : CAN_MTU;
}

std::optional<CanFrame> from_kernel(const canfd_frame& frame, std::size_t bytes) noexcept {
  if (bytes != CAN_MTU && bytes != CANFD_MTU) return std::nullopt;
  CanFrame out;
  out.fd = bytes == CANFD_MTU;
  out.error = (frame.can_id & CAN_ERR_FLAG) != 0;
  out.extended = !out.error && (frame.can_id & CAN_EFF_FLAG) != 0;
  out.remote = !out.error && (frame.can_id & CAN_RTR_FLAG) != 0;
  out.id = frame.can_id & (out.extended ? CAN_EFF_MASK : out.error ? CAN_ERR_MASK : CAN_SFF_MASK);
  out.bit_rate_switch = out.fd && (frame.flags & CANFD_BRS) != 0;
  const unsigned room = out.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN;
  out.size = static_cast<std::uint8_t>(std::min<unsigned>(frame.len, room));
  if (!out.remote) std::memcpy(out.data.data(), frame.data, out.size);
  return out;
}

}  // namespace foresight
