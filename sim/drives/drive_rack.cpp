#include "sim/drives/drive_rack.hpp"

#include <algorithm>
#include <mutex>

#include "common/error.hpp"
#include "common/text.hpp"
#include "sim/drives/cia402_node.hpp"
#include "sim/drives/powercube_node.hpp"

namespace foresight::sim {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);
constexpr int kMostSteps = 100;
constexpr std::size_t kOutbox = 256;
constexpr std::size_t kRemembered = 4096;  // steps

}  // namespace

DriveRack::DriveRack(Clock& clock, std::unique_ptr<CanBus> bus, const std::vector<NodeConfig>& nodes)
    : clock_(clock), bus_(std::move(bus)), now_(clock.now()), exists_(std::make_shared<const bool>(true)) {
  for (const NodeConfig& config : nodes) {
    config.validate();
    for (const auto& other : slots_)
      if (other->node->config().kind == config.kind && other->node->config().node == config.node)
        throw InputError(
            "drive " + in_quotes(config.name),
            "node " + std::to_string(config.node) + " is also that of " + in_quotes(other->node->config().name),
            "give each drive its own");
    auto slot = std::make_unique<Slot>();
    const auto send = [this, to = slot.get()](const CanFrame& frame) { post(*to, frame); };
    if (config.kind == NodeConfig::Kind::cia402)
      slot->node = std::make_unique<Cia402Node>(config, send);
    else
      slot->node = std::make_unique<PowerCubeNode>(config, send);
    slots_.push_back(std::move(slot));
  }
  positions_.resize(slots_.size());
  history_.emplace(slots_.size(), kRemembered);
  remember();
  if (auto* const stepped = dynamic_cast<SteppedClock*>(&clock))
    stepped->every(kStep, [this, exists = std::weak_ptr(exists_)](RobotTime now) {
      if (!exists.expired()) step(now);
    });
}

DriveRack::~DriveRack() = default;

void DriveRack::post(Slot& slot, const CanFrame& frame) {
  if (slot.silent) return;
  if (slot.outbox.size() >= kOutbox)
    ++dropped_;
  else
    slot.outbox.push_back({now_ + slot.delay, frame});
  flush(slot);
}

void DriveRack::flush(Slot& slot) {
  while (!slot.outbox.empty() && slot.outbox.front().due <= now_) {
    if (bus_->send(slot.outbox.front().frame) == CanSend::full) return;  // again at the next step
    slot.outbox.pop_front();
  }
}

void DriveRack::step(RobotTime now) {
  const std::lock_guard lock(mutex_);
  if (now - now_ > kMostSteps * kStep) now_ = now - kMostSteps * kStep;
  while (now_ + kStep <= now) {
    // A rack that was held up for long must not find its master silent meanwhile: each frame counts when it came.
    take_frames(now_ + kStep);
    now_ = now_ + kStep;
    for (const auto& slot : slots_) {
      flush(*slot);
      slot->node->step(now_, 1e-3);
    }
    remember();
  }
  take_frames(now);
}

void DriveRack::remember() {
  for (std::size_t i = 0; i < slots_.size(); ++i) positions_[i] = slots_[i]->node->shaft().position;
  history_->add(now_, positions_);
}

double DriveRack::position_at(std::size_t i, RobotTime time) const {
  const std::lock_guard lock(mutex_);
  return history_->at(i, time);
}

RobotTime DriveRack::known_until() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void DriveRack::take_frames(RobotTime until) {
  while (waiting_ || (waiting_ = bus_->receive(Duration(0)))) {
    if (waiting_->time > until) return;
    const CanFrame frame = *std::exchange(waiting_, std::nullopt);
    for (const auto& slot : slots_)
      if (!slot->deaf) slot->node->receive(frame, now_);
  }
}

void DriveRack::run(std::stop_token stop) {
  RobotTime next = clock_.now();
  while (!stop.stop_requested()) {
    next = std::max(next + kStep, clock_.now() - kMostSteps * kStep);
    clock_.sleep_until(next);
    step(clock_.now());
  }
}

const NodeConfig& DriveRack::config(std::size_t i) const {
  return slots_.at(i)->node->config();
}

std::optional<std::size_t> DriveRack::find(std::string_view name) const {
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (slots_[i]->node->config().name == name) return i;
  return std::nullopt;
}

ShaftState DriveRack::shaft(std::size_t i) const {
  const std::lock_guard lock(mutex_);
  return slots_.at(i)->node->shaft();
}

void DriveRack::forget_extremes(std::size_t i) {
  const std::lock_guard lock(mutex_);
  slots_.at(i)->node->forget_extremes();
}

void DriveRack::inject(std::size_t i, DriveFault fault, double value) {
  const std::lock_guard lock(mutex_);
  Slot& slot = *slots_.at(i);
  if (fault == DriveFault::recover) {
    slot.silent = slot.deaf = false;
    slot.delay = {};
    if (!std::exchange(slot.supplied, true)) slot.node->inject(DriveFault::reset, 0);
  }
  if (fault == DriveFault::silent) slot.silent = true;
  if (fault == DriveFault::unplugged || fault == DriveFault::no_power) slot.silent = slot.deaf = true;
  if (fault == DriveFault::no_power) {
    slot.supplied = false;
    slot.outbox.clear();
    slot.node->inject(DriveFault::reset, 0);  // it forgets all, and does not hear what would wake it
  }
  if (fault == DriveFault::slow) slot.delay = seconds(value);
  slot.node->inject(fault, value);
}

std::uint64_t DriveRack::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace foresight::sim
