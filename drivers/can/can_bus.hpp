// One end of a CAN bus.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/can/can_frame.hpp"

namespace foresight {

/// Fault confinement of ISO 11898-1, and what an operating system adds to it.
enum class CanBusState : std::uint8_t { active, warning, passive, bus_off, down };
const char* to_string(CanBusState state);

enum class CanSend : std::uint8_t {
  sent,      ///< handed to the controller; that it reached anybody is not known
  full,      ///< no room in the transmit queue: the frame is lost, the caller decides what then
  bus_down,  ///< bus-off, or the interface is down or gone
  invalid,   ///< not a frame of this bus (FD on a classic bus, identifier or size out of range)
};

/// Since the bus was opened.
struct CanCounters {
  std::uint64_t sent = 0, received = 0;
  std::uint64_t send_failures = 0;  ///< full or bus_down
  std::uint64_t lost = 0;           ///< received by the controller, dropped before we read them
  std::uint64_t error_frames = 0;
  std::uint64_t restarts = 0;  ///< recoveries from bus-off
};

/// SocketCAN (socket_can_bus.hpp), or an end of an in-process bus (in_process_bus.hpp). One thread uses one object; it
/// sees no frame that it sent itself. Nothing here allocates after construction.
class CanBus {
 public:
  virtual ~CanBus() = default;
  virtual const std::string& name() const noexcept = 0;  ///< "can0"; for messages
  /// Does not block.
  virtual CanSend send(const CanFrame& frame) noexcept = 0;
  /// The next frame, waiting `timeout` for it at most (0: only looks). Error frames come as frames.
  virtual std::optional<CanFrame> receive(Duration timeout) noexcept = 0;
  virtual CanBusState state() const noexcept = 0;
  virtual CanCounters counters() const noexcept = 0;
};

}  // namespace foresight
