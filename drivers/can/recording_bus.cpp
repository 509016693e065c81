#include "drivers/can/recording_bus.hpp"

#include <bit>

namespace foresight {

RecordingBus::RecordingBus(CanBus& bus, const Clock& clock, const std::filesystem::path& file, Duration log_epoch,
                           std::size_t capacity)
    : bus_(bus),
      clock_(clock),
      writer_(file),
      log_epoch_(log_epoch),
      ring_(std::bit_ceil(capacity)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

RecordingBus::~RecordingBus() {
  thread_.request_stop();
  thread_.join();
}

CanSend RecordingBus::send(const CanFrame& frame) noexcept {
  const CanSend result = bus_.send(frame);
  if (result == CanSend::sent) {
    CanFrame stamped = frame;
    stamped.time = clock_.now();
    note(stamped, true);
  }
  return result;
}

std::optional<CanFrame> RecordingBus::receive(Duration timeout) noexcept {
  const auto frame = bus_.receive(timeout);
  if (frame) note(*frame, false);
  return frame;
}

void RecordingBus::note(const CanFrame& frame, bool sent) noexcept {
  const std::size_t at = written_.load(std::memory_order_relaxed);
  if (at - read_.load(std::memory_order_acquire) == ring_.size()) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  ring_[at % ring_.size()] = {frame, sent};
  written_.store(at + 1, std::memory_order_release);
}

/// Looks every 5 ms: waking a thread for each frame would cost the caller a system call.
void RecordingBus::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  drain();
}

void RecordingBus::drain() {
  const std::size_t end = written_.load(std::memory_order_acquire);
  std::size_t at = read_.load(std::memory_order_relaxed);
  const bool any = at != end;
  for (; at != end; ++at) {
    const Entry& entry = ring_[at % ring_.size()];
    try {
      if (!failed_) writer_.write(Duration{entry.frame.time.ns} + log_epoch_, name(), entry.frame, entry.sent);
    } catch (const std::exception&) {
      failed_ = true;
    }
    if (failed_) dropped_.fetch_add(1, std::memory_order_relaxed);
    read_.store(at + 1, std::memory_order_release);
  }
  try {
    if (any && !failed_) writer_.flush();
  } catch (const std::exception&) {
    failed_ = true;
  }
}

}  // namespace foresight
