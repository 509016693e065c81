// Drives that answer at once, for what stands above them.
#pragma once

#include <algorithm>
#include <vector>

#include "drivers/drive/drive.hpp"

namespace foresight {

/// Follows every request and every set-point at once.
class PromptDrive final : public Drive {
 public:
  const DriveConfig& config() const noexcept override { return config_; }
  void identify() override {}
  DriveIdentity identity() const override { return {}; }
  void configure() override {}
  void request(DriveRequest what) noexcept override {
    requests.push_back(what);
    if (state.state == DriveState::offline || stuck) return;
    if (what == DriveRequest::reset_fault && state.state == DriveState::fault) state.state = DriveState::disabled;
    if (state.state == DriveState::fault) return;
    if (what == DriveRequest::enable) state.state = DriveState::enabled;
    if (what == DriveRequest::disable || what == DriveRequest::quick_stop) state.state = DriveState::disabled;
    if (what == DriveRequest::home) state.homed = !homes_slowly;
    if (what == DriveRequest::home && homes_slowly) state.state = DriveState::homing;
  }
  void set_point(double position, double) noexcept override {
    if (state.state == DriveState::enabled && coast == 0) state.position = std::max(position, stops_at);
  }
  DriveFeedback feedback() const noexcept override { return state; }
  bool asked(DriveRequest what) const { return std::find(requests.begin(), requests.end(), what) != requests.end(); }

  DriveFeedback state{{}, 0, 0, DriveState::disabled};
  std::vector<DriveRequest> requests;
  bool stuck = false;         ///< ignores requests
  bool homes_slowly = false;  ///< moves by itself until `coast` and `state` are set
  double stops_at = -1e9;     ///< something rigid is there: the shaft comes no further down
  double coast = 0;           ///< way per cycle that the shaft makes, whatever is asked of it

 private:
  DriveConfig config_;
};

/// Keeps the drives' feedback fresh.
class PromptNetwork final : public DriveNetwork {
 public:
  explicit PromptNetwork(std::vector<PromptDrive>& drives) : drives_(drives) {}
  std::span<Drive* const> drives() const noexcept override { return {}; }
  void receive(RobotTime now) noexcept override {
    for (PromptDrive& drive : drives_) {
      drive.state.time = now;
      drive.state.position += drive.coast;
    }
  }
  void send(RobotTime) noexcept override {}
  bool healthy() const noexcept override { return fault == nullptr; }
  const char* reason() const noexcept override { return fault == nullptr ? "" : fault; }

  const char* fault = nullptr;

 private:
  std::vector<PromptDrive>& drives_;
};

}  // namespace foresight
