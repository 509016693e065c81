// PowerCube modules on one bus.
#pragma once

#include <memory>
#include <vector>

#include "drivers/powercube/module.hpp"

namespace foresight::powercube {

/// All modules that answer on the bus, by id. Blocks for about 0.2 s and 10 ms per module; moves nothing.
/// Throws RuntimeFailure (the bus is down, or a module that answered before falls silent).
std::vector<ModuleInfo> scan(CanBus& bus, Clock& clock);

/// See DriveNetwork. Feeds the modules' watchdogs in send(), at least every 40 ms as long as it is called once a
/// cycle. While the bus is down or another master was seen, all modules are halted and cannot be enabled; another
/// master is remembered until this object goes.
class Network final : public DriveNetwork {
 public:
  /// `bus` and `clock` must outlive this; the clock times only the set-up. Throws InputError (a module id twice, a
  /// config or an option that makes no sense).
  Network(CanBus& bus, Clock& clock, const std::vector<DriveConfig>& drives, const Options& options = {});

  std::span<Drive* const> drives() const noexcept override { return drives_; }
  void receive(RobotTime now) noexcept override;
  void send(RobotTime now) noexcept override;
  bool healthy() const noexcept override { return *reason() == '\0'; }
  const char* reason() const noexcept override;

  const Module& module(std::size_t index) const { return *modules_[index]; }

 private:
  CanBus& bus_;
  Link link_;
  const Options options_;
  std::vector<std::unique_ptr<Module>> modules_;
  std::vector<Drive*> drives_;
  std::array<Module*, kLargestModule + 1> by_id_{};
  std::optional<RobotTime> fed_;
  bool other_master_ = false;
};

}  // namespace foresight::powercube
