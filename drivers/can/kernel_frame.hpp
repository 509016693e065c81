// Our frame and the kernel's (linux/can.h), both ways.
#pragma once

#include <linux/can.h>

#include <optional>

#include "drivers/can/can_frame.hpp"

namespace foresight {

/// Whether `frame` can be sent: identifier and size in range, no error frame, nothing remote in CAN FD.
bool is_sendable(const CanFrame& frame) noexcept;

/// Fills `out` and returns how many bytes of it to write (CAN_MTU or CANFD_MTU). `frame` must be sendable.
std::size_t to_kernel(const CanFrame& frame, canfd_frame& out) noexcept;

/// From what a raw socket gave; `bytes` says whether it is classic or FD. Nothing where it is neither.
/// `time` stays 0.
std::optional<CanFrame> from_kernel(const canfd_frame& frame, std::size_t bytes) noexcept;

}  // namespace foresight
