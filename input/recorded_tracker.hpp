// A recorded device as if it were there.
#pragma once

#include "input/tracker_trace.hpp"

namespace foresight {

/// Begins with the first read(). At its end the device has gone.
class RecordedTracker final : public Tracker {
 public:
  /// `trace` has rows.
  explicit RecordedTracker(TrackerTrace trace) : trace_(std::move(trace)) {}

  std::string name() const override { return "recording of " + trace_.what; }
  TrackerState read(OperatorTime now) noexcept override;
  bool ended() const noexcept { return ended_; }
  /// How far its gripper goes beyond what counts.
  const TrackerTrace::Beyond& beyond() const noexcept { return trace_.beyond; }
  Duration length() const noexcept { return trace_.rows.back().time; }

 private:
  TrackerTrace trace_;
  std::optional<OperatorTime> begun_;
  std::size_t at_ = 0;
  bool ended_ = false;
};

}  // namespace foresight
