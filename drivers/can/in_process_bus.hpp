// A CAN bus inside the process, for machines without AF_CAN and for tests.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/clock.hpp"
#include "drivers/can/can_bits.hpp"
#include "drivers/can/can_bus.hpp"
#include "drivers/can/can_faults.hpp"

namespace foresight {

struct InProcessBusOptions {
  /// With a bit rate, one frame after the other occupies the wire for as long as its bits take; of the ends that want
  /// to send, the one with the lowest identifier goes first. 0: frames arrive the instant they are sent.
  CanBitRates wire{0, 0};
  CanFaults faults;
  std::size_t transmit_queue = 128;  ///< frames of one end that wait for the wire; 1 or more
  std::size_t in_flight = 4096;      ///< frames on their delayed way to one receiver or another; 1 or more

  /// Throws InputError.
  void validate() const;
};

/// The medium. Every frame that one end sends reaches all others, in the same order. Outlives its
/// ends. Thread-safe; with a SteppedClock, all ends in one thread, and waiting ends move it on. Then
/// all that happens, faults included, is the same in every run.
///
///   end's transmit queue -> arbitration, wire time -> per receiver: faults, delay -> its receive ring
class InProcessBus {
 public:
  /// Throws InputError for options that make no sense.
  InProcessBus(std::string name, Clock& clock, const InProcessBusOptions& options = {});
  ~InProcessBus();
  InProcessBus(const InProcessBus&) = delete;
  InProcessBus& operator=(const InProcessBus&) = delete;

  /// A new end; frames sent before are not seen there. It holds up to `capacity` unread frames and
  /// drops (and counts) what comes after.
  std::unique_ptr<CanBus> attach(std::size_t capacity = 4096);

  /// Takes an end of this bus off it, as a controller whose error counter ran over: what it wanted to send is gone, it
  /// hears nothing, send() returns bus_down, and an error frame tells its owner. Ends after faults.recovery, if any.
  void force_bus_off(CanBus& end);
  /// Ends bus-off now. The owner gets an error frame, and counters().restarts one more.
  void restart(CanBus& end);

  /// How long frames have occupied the wire, since the beginning. 0 without a bit rate.
  Duration busy();

 private:
  class End;
  struct Flight {
    RobotTime due;
    std::uint64_t number;  // keeps the order of frames that are due at one instant
    End* to;
    CanFrame frame;
  };

  // All of these with mutex_ held.
  CanSend send(End& from, const CanFrame& frame);
  void advance(RobotTime now);
  void transmit(RobotTime now);
  End* win_arbitration(RobotTime start) const;
  void put_on_wire(End& from, RobotTime start);
  void deliver(const End& from, const CanFrame& frame, RobotTime at);
  void fly(End& to, const CanFrame& frame, RobotTime due);
  void go_bus_off(End& end, RobotTime now);
  void recover(End& end, RobotTime now);
  RobotTime next_event(RobotTime limit) const;
  void wake();

  std::string name_;
  Clock& clock_;
  SteppedClock* stepped_;  // clock_, where it is one
  InProcessBusOptions options_;
  bool instant_;  // no wire time and no faults
  FaultDice dice_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::uint64_t wakes_ = 0;
  std::vector<End*> ends_;
  std::vector<Flight> flights_;  // a heap, the next one due in front
  std::uint64_t flown_ = 0;
  RobotTime wire_free_;
  Duration busy_{0};
};

}  // namespace foresight
