// A CAN bus whose load and counters another thread can watch.
#pragma once

#include "common/clock.hpp"
#include "common/triple_buffer.hpp"
#include "drivers/can/can_bits.hpp"
#include "drivers/can/can_bus.hpp"

namespace foresight {

/// Passes everything on to another bus. One thread, but for snapshot(), which one other thread may call.
class MeteredBus final : public CanBus {
 public:
  struct Snapshot {
    CanBusState state = CanBusState::active;
    CanCounters counters;
    double load = 0;  ///< share of the last second in which frames that we sent or received were on the wire
  };
  /// `bus` and `clock` must outlive this.
  MeteredBus(CanBus& bus, const Clock& clock, const CanBitRates& rates);

  const std::string& name() const noexcept override { return bus_.name(); }
  CanSend send(const CanFrame& frame) noexcept override;
  std::optional<CanFrame> receive(Duration timeout) noexcept override;
  CanBusState state() const noexcept override { return bus_.state(); }
  CanCounters counters() const noexcept override { return bus_.counters(); }

  /// At most 100 ms old while frames are asked for.
  Snapshot snapshot() const;

 private:
  void publish(RobotTime now) noexcept;

  CanBus& bus_;
  const Clock& clock_;
  CanBusLoad load_;
  RobotTime published_at_;
  mutable TripleBuffer<Snapshot> published_;
  mutable Snapshot last_;
};

}  // namespace foresight
