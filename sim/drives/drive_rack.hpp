// Many emulated drives on one CAN bus, in stepped or in real time.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>
#include <vector>

#include "common/clock.hpp"
#include "common/priority_mutex.hpp"
#include "drivers/can/can_bus.hpp"
#include "sim/drives/drive_node.hpp"
#include "sim/drives/shaft_history.hpp"

namespace foresight::sim {

/// step() or run() from one thread; the others from any. At a SteppedClock it registers
/// itself for every millisecond, and nobody else calls step(); it may be destroyed before the clock. The bus end
/// is its own.
class DriveRack {
 public:
  /// Throws InputError where a configuration is wrong (naming drive and field), two nodes of one protocol share a
  /// number, or a dictionary cannot be read.
  DriveRack(Clock& clock, std::unique_ptr<CanBus> bus, const std::vector<NodeConfig>& nodes);
  ~DriveRack();
  DriveRack(const DriveRack&) = delete;
  DriveRack& operator=(const DriveRack&) = delete;

  /// Takes in all frames that came, moves all shafts on to `now` in steps of 1 ms (100 at most, more are left out)
  /// and sends answers. Does not block.
  void step(RobotTime now);
  /// step() every millisecond, until asked to stop.
  void run(std::stop_token stop);

  std::size_t size() const { return slots_.size(); }
  const NodeConfig& config(std::size_t i) const;
  std::optional<std::size_t> find(std::string_view name) const;
  /// What the shaft truly does, whatever the drive tells.
  ShaftState shaft(std::size_t i) const;
  /// Where the shaft truly was at an instant of the last four seconds, to well below a millisecond's way; outside of
  /// them, where they begin or end.
  double position_at(std::size_t i, RobotTime time) const;
  /// To where the shafts' motion is known; some milliseconds behind the clock in real time.
  RobotTime known_until() const;
  void forget_extremes(std::size_t i);
  /// `value`: see DriveFault.
  void inject(std::size_t i, DriveFault fault, double value = 0);
  /// Frames that found no room on the bus for more than 256 others.
  std::uint64_t dropped() const;

 private:
  struct Waiting {
    RobotTime due;
    CanFrame frame;
  };
  struct Slot {
    std::unique_ptr<DriveNode> node;
    std::deque<Waiting> outbox;
    bool silent = false, deaf = false, supplied = true;
    Duration delay{};
  };
  /// All that came until then; what came later waits.
  void take_frames(RobotTime until);
  void post(Slot& slot, const CanFrame& frame);
  void flush(Slot& slot);
  void remember();

  Clock& clock_;
  std::unique_ptr<CanBus> bus_;
  std::vector<std::unique_ptr<Slot>> slots_;
  mutable PriorityMutex mutex_;  // cameras and consoles ask, at leisure; the real-time thread steps
  RobotTime now_;
  std::optional<ShaftHistory> history_;  // set once the shafts are there
  std::vector<double> positions_;        // of all shafts at now_
  std::optional<CanFrame> waiting_;      // came after the step that is due
  std::uint64_t dropped_ = 0;
  std::shared_ptr<const bool> exists_;  // tells the clock's task that `this` is still there
};

}  // namespace foresight::sim
