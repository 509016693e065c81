// A CAN bus that writes down what passes.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "common/clock.hpp"
#include "drivers/can/can_bus.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/can/receive_time.hpp"

namespace foresight {

/// Passes everything on to another bus, and every frame that was sent or received into a log (candump_log.hpp; T:
/// sent). The caller's thread only copies frames into a ring; a thread of the recorder's own writes them. Where that
/// cannot keep up, the newest frames are missing from the log, never from the bus, and counted. One thread.
class RecordingBus final : public CanBus {
 public:
  /// `bus` and `clock` (stamps what is sent) must outlive this. `log_epoch`: what to add to times for the log; the
  /// default makes unix times of CLOCK_MONOTONIC's. `capacity`: frames, rounded up to a power of two.
  /// Throws RuntimeFailure where the file cannot be made.
  RecordingBus(CanBus& bus, const Clock& clock, const std::filesystem::path& file,
               Duration log_epoch = realtime_minus_monotonic(), std::size_t capacity = 8192);
  /// Writes what is left, and closes the file.
  ~RecordingBus() override;

  const std::string& name() const noexcept override { return bus_.name(); }
  CanSend send(const CanFrame& frame) noexcept override;
  std::optional<CanFrame> receive(Duration timeout) noexcept override;
  CanBusState state() const noexcept override { return bus_.state(); }
  CanCounters counters() const noexcept override { return bus_.counters(); }

  /// Frames that are not in the log: the ring was full, or the disk. Any thread.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  /// Any thread. The disk was full or the like: the log ends early.
  bool failed() const noexcept { return failed_.load(std::memory_order_relaxed); }

 private:
  struct Entry {
    CanFrame frame;
    bool sent;
  };
  void note(const CanFrame& frame, bool sent) noexcept;
  void run(const std::stop_token& stop);
  void drain();

  CanBus& bus_;
  const Clock& clock_;
  CandumpWriter writer_;
  Duration log_epoch_;
  std::vector<Entry> ring_;
  std::atomic<std::size_t> written_{0}, read_{0};  // entries ever put in and taken out
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> failed_{false};
  std::jthread thread_;
};

}  // namespace foresight
