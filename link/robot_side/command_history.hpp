// Which set-points of the line the robot had when, and who stopped it over the line: from the thread that takes them in
// to those that tell of it.
#pragma once

#include <array>
#include <mutex>
#include <string>

#include "link/control/messages.hpp"

namespace foresight::link {

/// Any thread.
class CommandHistory {
 public:
  /// The newest that was taken when it came.
  void add(const TakenSetPoint& taken) {
    const std::lock_guard lock(mutex_);
    if (taken.from == newest().from && taken.sequence == newest().sequence) return;
    kept_[++count_ % kept_.size()] = taken;
  }
  /// Who asked for the newest stop, before the robot gets it.
  void stopped_by(const std::string& name) {
    const std::lock_guard lock(mutex_);
    stopper_ = name;
  }
  /// The newest set-point that had come by `time`, of those that are kept: a second's; all 0: none.
  TakenSetPoint newest_by(RobotTime time) const {
    const std::lock_guard lock(mutex_);
    for (std::size_t back = 0; back < kept_.size() && back < count_; ++back)
      if (const TakenSetPoint& one = kept_[(count_ - back) % kept_.size()]; one.came <= time) return one;
    return {};
  }
  /// "" where nobody has asked for a stop.
  std::string stopper() const {
    const std::lock_guard lock(mutex_);
    return stopper_;
  }

 private:
  const TakenSetPoint& newest() const { return kept_[count_ % kept_.size()]; }

  mutable std::mutex mutex_;
  std::array<TakenSetPoint, 128> kept_{};
  std::size_t count_ = 0;
  std::string stopper_;
};

}  // namespace foresight::link
