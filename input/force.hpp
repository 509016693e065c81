// Devices that can push back against the hand: what they are told of a contact.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "input/tracker.hpp"

namespace foresight {

/// What the tool feels. A plain value.
struct HandContact {
  /// Unit: the way out of what is touched, in the axes of the device's space (HandControl::in_space()); 0: nothing is.
  Eigen::Vector3d out_in_space{0, 0, 0};
  double depth = 0;    ///< m, of the hand behind the surface
  double damping = 0;  ///< N s/m, against the hand's motion
};

/// A device that can push.
class ForceSink {
 public:
  virtual ~ForceSink() = default;
  virtual std::string name() const = 0;
  /// Many times a second; all within limits already (BoundedForce). Without a further call the device must let go
  /// within 0.2 s. Neither throws nor waits.
  virtual void push(OperatorTime now, const HandContact& contact) noexcept = 0;
};

struct ForceLimits {
  double depth = 0.02;                                    ///< m
  double depth_per_s = 0.2;                               ///< m/s: how fast the depth may grow: no kicks
  double damping = 10;                                    ///< N s/m
  Duration stale_after = std::chrono::milliseconds(100);  ///< of a contact that was not told anew
};

/// Stands between whoever computes contacts and the device: numbers that are none, a hand that is not engaged, and news
/// that stay away make the device let go. One thread; neither throws nor allocates.
class BoundedForce {
 public:
  explicit BoundedForce(ForceSink& device, const ForceLimits& limits = {}) noexcept
      : device_(device), limits_(limits) {}

  void feel(OperatorTime now, const HandContact& contact) noexcept;
  /// Each cycle. `engaged`: the hand moves the tool.
  void cycle(OperatorTime now, bool engaged) noexcept;

 private:
  ForceSink& device_;
  ForceLimits limits_;
  HandContact wanted_;
  std::optional<OperatorTime> felt_, last_;
  double depth_ = 0;
};

/// Keeps what it was told, for tests and to be looked at. At most `most` rows; then the oldest go.
class RecordedForce final : public ForceSink {
 public:
  struct Row {
    OperatorTime time;
    HandContact contact;
  };
  explicit RecordedForce(std::size_t most = 100'000) : most_(most) { rows_.reserve(most); }
  std::string name() const override { return "recording of forces"; }
  void push(OperatorTime now, const HandContact& contact) noexcept override;
  /// Oldest first.
  std::vector<Row> rows() const;

 private:
  std::size_t most_, oldest_ = 0;
  std::vector<Row> rows_;
};

}  // namespace foresight
