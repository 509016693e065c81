#include "drivers/can/in_process_bus.hpp"

#include <linux/can/error.h>

#include <algorithm>

#include "common/error.hpp"
#include "drivers/can/frame_ring.hpp"
#include "drivers/can/kernel_frame.hpp"

namespace foresight {
namespace {

CanFrame error_frame(std::uint32_t error_class) {
  CanFrame out;
  out.error = true;
  out.id = error_class;
  out.size = CAN_ERR_DLC;
  return out;
}

/// The bits in the order in which they decide on the wire, as one number: lower wins. An 11-bit frame
/// wins over a 29-bit one with the same first 11 bits, a data frame over a remote one.
std::uint64_t arbitration_key(const CanFrame& frame) {
  const std::uint64_t first = frame.extended ? frame.id >> 18 : frame.id;
  const std::uint64_t rest = frame.extended ? 0b11u << 19 | (frame.id & 0x3ffff) << 1 | (frame.remote ? 1u : 0u)
                                            : (frame.remote ? 1u << 20 : 0u);
  return first << 21 | rest;
}

constexpr CanBits kErrorFlag{6 + 6 + 8 + 3, 0};  // flag, its echo, delimiter, intermission; ISO 11898-1 at its longest
constexpr CanBits kShortest{47, 0};

}  // namespace

class InProcessBus::End final : public CanBus {
 public:
  End(InProcessBus& bus, std::size_t capacity)
      : bus_(bus), received_(capacity), waiting_(bus.options_.transmit_queue) {}
  ~End() override {
    const std::lock_guard lock(bus_.mutex_);
    std::erase(bus_.ends_, this);
    std::erase_if(bus_.flights_, [&](const Flight& flight) { return flight.to == this; });
    std::make_heap(bus_.flights_.begin(), bus_.flights_.end(), later);
  }

  const std::string& name() const noexcept override { return bus_.name_; }

  CanSend send(const CanFrame& frame) noexcept override {
    if (!is_sendable(frame)) return CanSend::invalid;
    const std::lock_guard lock(bus_.mutex_);
    const CanSend result = bus_.send(*this, frame);
    ++(result == CanSend::sent ? counters_.sent : counters_.send_failures);
    return result;
  }

  std::optional<CanFrame> receive(Duration timeout) noexcept override {
    const RobotTime until = bus_.clock_.now() + timeout;
    std::unique_lock lock(bus_.mutex_);
    while (true) {
      const RobotTime now = bus_.clock_.now();
      bus_.advance(now);
      if (!received_.empty()) break;
      if (now >= until) return std::nullopt;
      const RobotTime next = std::max(bus_.next_event(until), now + Duration{1});
      if (bus_.stepped_ != nullptr) {
        lock.unlock();
        bus_.stepped_->step_towards(next);
        lock.lock();
      } else {
        bus_.arrived_.wait_for(lock, next - now, [&, seen = bus_.wakes_] { return bus_.wakes_ != seen; });
      }
    }
    ++counters_.received;
    return received_.pop();
  }

  CanBusState state() const noexcept override {
    const std::lock_guard lock(bus_.mutex_);
    bus_.advance(bus_.clock_.now());
    return state_;
  }
  CanCounters counters() const noexcept override {
    const std::lock_guard lock(bus_.mutex_);
    return counters_;
  }

  void take(const CanFrame& frame) {
    if (frame.error) ++counters_.error_frames;
    if (!received_.push(frame)) ++counters_.lost;
  }

  static bool later(const Flight& a, const Flight& b) { return a.due != b.due ? a.due > b.due : a.number > b.number; }

 private:
  friend InProcessBus;
  InProcessBus& bus_;
  FrameRing received_;
  FrameRing waiting_;  // for the wire; `time` says since when
  CanCounters counters_;
  CanBusState state_ = CanBusState::active;
  RobotTime recovers_at_;  // 0: not by itself
  RobotTime last_due_;     // of the frame in flight that must not be overtaken
};

void InProcessBusOptions::validate() const {
  faults.validate();
  if (wire.bit_rate < 0 || wire.data_bit_rate < 0 || wire.bit_rate > 1'000'000)
    throw InputError("wire.bit_rate", std::to_string(wire.bit_rate) + " bit/s", "give 0 (instant) to 1000000");
  if (transmit_queue == 0 || in_flight == 0)
    throw InputError("transmit_queue, in_flight", "0 frames", "give 1 or more");
}

InProcessBus::InProcessBus(std::string name, Clock& clock, const InProcessBusOptions& options)
    : name_(std::move(name)),
      clock_(clock),
      stepped_(dynamic_cast<SteppedClock*>(&clock)),
      options_(options),
      instant_(options.wire.bit_rate == 0 && !options.faults.any()),
      dice_(options.faults.seed) {
  options_.validate();
  flights_.reserve(options_.in_flight);
}
InProcessBus::~InProcessBus() = default;

std::unique_ptr<CanBus> InProcessBus::attach(std::size_t capacity) {
  auto end = std::make_unique<End>(*this, capacity);
  const std::lock_guard lock(mutex_);
  ends_.push_back(end.get());
  return end;
}

void InProcessBus::force_bus_off(CanBus& end) {
  const std::lock_guard lock(mutex_);
  go_bus_off(dynamic_cast<End&>(end), clock_.now());
}

void InProcessBus::restart(CanBus& end) {
  const std::lock_guard lock(mutex_);
  recover(dynamic_cast<End&>(end), clock_.now());
}

Duration InProcessBus::busy() {
  const std::lock_guard lock(mutex_);
  advance(clock_.now());
  return busy_;
}

CanSend InProcessBus::send(End& from, const CanFrame& frame) {
  const RobotTime now = clock_.now();
  advance(now);
  if (from.state_ == CanBusState::bus_off) return CanSend::bus_down;
  CanFrame stamped = frame;
  stamped.time = now;
  if (options_.wire.bit_rate > 0) {
    if (!from.waiting_.push(stamped)) return CanSend::full;
  } else if (dice_.happens(options_.faults.bus_off)) {
    go_bus_off(from, now);
  } else {
    if (dice_.happens(options_.faults.error_frame))
      for (End* end : ends_) fly(*end, error_frame(CAN_ERR_PROT | CAN_ERR_BUSERROR), now);
    deliver(from, stamped, now);
  }
  advance(now);
  wake();
  return CanSend::sent;
}

/// Brings the bus to where it is at `now`. Events happen at their own instants, however late this is called.
void InProcessBus::advance(RobotTime now) {
  for (End* end : ends_)
    if (end->recovers_at_.ns != 0 && end->recovers_at_ <= now) recover(*end, end->recovers_at_);
  if (options_.wire.bit_rate > 0) transmit(now);
  while (!flights_.empty() && flights_.front().due <= now) {
    std::pop_heap(flights_.begin(), flights_.end(), End::later);
    Flight& flight = flights_.back();
    flight.frame.time = flight.due;
    if (flight.to->state_ != CanBusState::bus_off) flight.to->take(flight.frame);
    flights_.pop_back();
  }
}

void InProcessBus::transmit(RobotTime now) {
  while (true) {
    RobotTime start = now;
    for (const End* end : ends_)
      if (!end->waiting_.empty()) start = std::min(start, std::max(wire_free_, end->waiting_.front().time));
    // At `now` itself others may still want to send: who wins is only known later.
    if (start >= now) return;
    put_on_wire(*win_arbitration(start), start);
  }
}

InProcessBus::End* InProcessBus::win_arbitration(RobotTime start) const {
  End* winner = nullptr;
  for (End* end : ends_) {
    if (end->waiting_.empty() || end->waiting_.front().time > start) continue;
    if (winner == nullptr || arbitration_key(end->waiting_.front()) < arbitration_key(winner->waiting_.front()))
      winner = end;
  }
  return winner;
}

void InProcessBus::put_on_wire(End& from, RobotTime start) {
  const CanFrame frame = from.waiting_.pop();
  const Duration length = wire_time(can_bits(frame), options_.wire);
  Duration taken = length;
  if (dice_.happens(options_.faults.bus_off)) {
    go_bus_off(from, start + length);
  } else {
    if (dice_.happens(options_.faults.error_frame)) {
      const Duration flag = wire_time(kErrorFlag, options_.wire);
      for (End* end : ends_) fly(*end, error_frame(CAN_ERR_PROT | CAN_ERR_BUSERROR), start + length + flag);
      taken += flag + length;
    }
    deliver(from, frame, start + taken);
  }
  wire_free_ = start + taken;
  busy_ += taken;
}

/// A frame that was on the wire until `at`, to all other ends, each with faults of its own.
void InProcessBus::deliver(const End& from, const CanFrame& frame, RobotTime at) {
  const CanFaults& faults = options_.faults;
  for (End* end : ends_) {
    if (end == &from || dice_.happens(faults.loss)) continue;
    RobotTime due = at;
    if (faults.delay_max.count() > 0) {
      const auto spread = static_cast<double>((faults.delay_max - faults.delay_min).count());
      due = due + faults.delay_min + Duration{static_cast<std::int64_t>(spread * dice_.roll())};
    }
    due = std::max(due, end->last_due_);
    if (dice_.happens(faults.reorder))
      due = due + faults.reorder_by;
    else
      end->last_due_ = due;
    fly(*end, frame, due);
    if (dice_.happens(faults.duplicate)) fly(*end, frame, due);
  }
}

void InProcessBus::fly(End& to, const CanFrame& frame, RobotTime due) {
  if (instant_) {  // no detour for what most tests and the simulated lab use
    CanFrame arrived = frame;
    arrived.time = due;
    if (to.state_ != CanBusState::bus_off) to.take(arrived);
    return;
  }
  if (flights_.size() == options_.in_flight) {
    ++to.counters_.lost;
    return;
  }
  flights_.push_back({due, flown_++, &to, frame});
  std::push_heap(flights_.begin(), flights_.end(), End::later);
}

void InProcessBus::go_bus_off(End& end, RobotTime now) {
  if (end.state_ == CanBusState::bus_off) return;
  end.state_ = CanBusState::bus_off;
  end.counters_.send_failures += end.waiting_.size();
  end.waiting_.clear();
  const Duration recovery = options_.faults.recovery;
  end.recovers_at_ = recovery.count() > 0 ? now + recovery : RobotTime{};
  CanFrame told = error_frame(CAN_ERR_BUSOFF);
  told.time = now;
  end.take(told);
  wake();
}

void InProcessBus::recover(End& end, RobotTime now) {
  if (end.state_ != CanBusState::bus_off) return;
  end.state_ = CanBusState::active;
  end.recovers_at_ = {};
  ++end.counters_.restarts;
  CanFrame told = error_frame(CAN_ERR_RESTARTED);
  told.time = now;
  end.take(told);
  wake();
}

/// When something may happen next, `limit` at most: no wait is longer.
RobotTime InProcessBus::next_event(RobotTime limit) const {
  RobotTime next = limit;
  if (!flights_.empty()) next = std::min(next, flights_.front().due);
  for (const End* end : ends_) {
    if (end->recovers_at_.ns != 0) next = std::min(next, end->recovers_at_);
    if (!end->waiting_.empty())
      next = std::min(next, std::max(wire_free_, end->waiting_.front().time) + wire_time(kShortest, options_.wire));
  }
  return next;
}

/// Other threads look anew at what comes next.
void InProcessBus::wake() {
  ++wakes_;
  arrived_.notify_all();
}

}  // namespace foresight
