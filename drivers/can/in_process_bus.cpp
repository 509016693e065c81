#include "drivers/can/in_process_bus.hpp"

#include <algorithm>

namespace foresight {

class InProcessBus::End final : public CanBus {
 public:
  End(InProcessBus& bus, std::size_t capacity) : bus_(bus), ring_(capacity) {}
  ~End() override {
    const std::lock_guard lock(bus_.mutex_);
    std::erase(bus_.ends_, this);
  }

  const std::string& name() const noexcept override { return bus_.name_; }
  CanSend send(const CanFrame& frame) noexcept override {
    const std::uint32_t largest = frame.extended ? 0x1fffffff : 0x7ff;
    if (frame.id > largest || frame.error || frame.size > (frame.fd ? 64 : 8)) return CanSend::invalid;
    ++counters_.sent;
    bus_.send(*this, frame);
    return CanSend::sent;
  }
  std::optional<CanFrame> receive(Duration timeout) noexcept override {
    const RobotTime until = bus_.clock_.now() + timeout;
    std::unique_lock lock(bus_.mutex_);
    if (bus_.stepped_ != nullptr) {
      while (count_ == 0 && bus_.stepped_->now() < until) {
        lock.unlock();
        bus_.stepped_->step_towards(until);
        lock.lock();
      }
    } else if (count_ == 0 && timeout.count() > 0) {
      bus_.arrived_.wait_for(lock, timeout, [&] { return count_ > 0; });
    }
    if (count_ == 0) return std::nullopt;
    const CanFrame frame = ring_[first_];
    first_ = (first_ + 1) % ring_.size();
    --count_;
    ++counters_.received;
    return frame;
  }
  CanBusState state() const noexcept override { return CanBusState::active; }
  CanCounters counters() const noexcept override {
    const std::lock_guard lock(bus_.mutex_);
    return counters_;
  }

  void deliver(const CanFrame& frame) {
    if (count_ == ring_.size()) {
      ++counters_.lost;
      return;
    }
    ring_[(first_ + count_) % ring_.size()] = frame;
    ++count_;
  }

 private:
  InProcessBus& bus_;
  std::vector<CanFrame> ring_;
  std::size_t first_ = 0, count_ = 0;
  CanCounters counters_;
};

InProcessBus::InProcessBus(std::string name, Clock& clock)
    : name_(std::move(name)), clock_(clock), stepped_(dynamic_cast<SteppedClock*>(&clock)) {}
InProcessBus::~InProcessBus() = default;

std::unique_ptr<CanBus> InProcessBus::attach(std::size_t capacity) {
  auto end = std::make_unique<End>(*this, capacity);
  const std::lock_guard lock(mutex_);
  ends_.push_back(end.get());
  return end;
}

void InProcessBus::send(const End& from, const CanFrame& frame) {
  CanFrame received = frame;
  received.time = clock_.now();
  const std::lock_guard lock(mutex_);
  for (End* end : ends_)
    if (end != &from) end->deliver(received);
  arrived_.notify_all();
}

}  // namespace foresight
