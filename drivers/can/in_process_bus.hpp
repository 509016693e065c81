// A CAN bus inside the process, for machines without AF_CAN and for tests.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/clock.hpp"
#include "drivers/can/can_bus.hpp"

namespace foresight {

/// The medium. Every frame that one end sends reaches all others, in the same order. Outlives its
/// ends. Thread-safe; with a SteppedClock, all ends in one thread, and waiting ends move it on.
class InProcessBus {
 public:
  InProcessBus(std::string name, Clock& clock);
  ~InProcessBus();
  InProcessBus(const InProcessBus&) = delete;
  InProcessBus& operator=(const InProcessBus&) = delete;

  /// A new end; frames sent before are not seen there. It holds up to `capacity` unread frames and
  /// drops (and counts) what comes after.
  std::unique_ptr<CanBus> attach(std::size_t capacity = 4096);

 private:
  class End;
  void send(const End& from, const CanFrame& frame);

  std::string name_;
  Clock& clock_;
  SteppedClock* stepped_;  // clock_, where it is one
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<End*> ends_;
};

}  // namespace foresight
