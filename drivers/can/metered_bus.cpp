#include "drivers/can/metered_bus.hpp"

namespace foresight {

using namespace std::chrono_literals;

MeteredBus::MeteredBus(CanBus& bus, const Clock& clock, const CanBitRates& rates)
    : bus_(bus), clock_(clock), load_(rates) {}

CanSend MeteredBus::send(const CanFrame& frame) noexcept {
  const CanSend result = bus_.send(frame);
  if (result == CanSend::sent) load_.add(frame, clock_.now());
  return result;
}

std::optional<CanFrame> MeteredBus::receive(Duration timeout) noexcept {
  const auto frame = bus_.receive(timeout);
  const RobotTime now = clock_.now();
  if (frame && !frame->error) load_.add(*frame, now);
  if (now - published_at_ >= 100ms) publish(now);
  return frame;
}

void MeteredBus::publish(RobotTime now) noexcept {
  published_at_ = now;
  published_.put({bus_.state(), bus_.counters(), load_.load(now)});
}

MeteredBus::Snapshot MeteredBus::snapshot() const {
  if (const auto newer = published_.take()) last_ = *newer;
  return last_;
}

}  // namespace foresight
