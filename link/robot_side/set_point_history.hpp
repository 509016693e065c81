// Which set-points of the line the robot had when: from the thread that takes them in to the one that tells of it.
#pragma once

#include <array>
#include <mutex>

#include "link/control/messages.hpp"

namespace foresight::link {

/// Any thread.
class SetPointHistory {
 public:
  /// The newest that was taken when it came.
  void add(const TakenSetPoint& taken) {
    const std::lock_guard lock(mutex_);
    if (taken.from == newest().from && taken.sequence == newest().sequence) return;
    kept_[++count_ % kept_.size()] = taken;
  }
  /// The newest that had come by `time`, of those that are kept: a second's; all 0: none.
  TakenSetPoint newest_by(RobotTime time) const {
    const std::lock_guard lock(mutex_);
    for (std::size_t back = 0; back < kept_.size() && back < count_; ++back)
      if (const TakenSetPoint& one = kept_[(count_ - back) % kept_.size()]; one.came <= time) return one;
    return {};
  }

 private:
  const TakenSetPoint& newest() const { return kept_[count_ % kept_.size()]; }

  mutable std::mutex mutex_;
  std::array<TakenSetPoint, 128> kept_{};
  std::size_t count_ = 0;
};

}  // namespace foresight::link
