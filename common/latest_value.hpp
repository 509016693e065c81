// Hands the newest value from one thread to another.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "common/time.hpp"

namespace foresight {

/// One slot, never a queue: a slow reader gets the newest value, and those it missed are counted. Any thread may call
/// anything. `T` must be movable without throwing. Does not allocate; holds its lock only for a move.
template <typename T>
class LatestValue {
 public:
  void put(T value) noexcept {
    std::optional<T> slot(std::move(value));
    {
      const std::lock_guard lock(mutex_);
      if (value_) ++dropped_;
      value_.swap(slot);
    }  // the old value, now in `slot`, goes without the lock
    arrived_.notify_one();
  }

  /// The newest value not yet taken, waiting for it up to `timeout` (0: only looks).
  std::optional<T> take(Duration timeout = Duration{0}) noexcept {
    std::unique_lock lock(mutex_);
    if (!value_ && timeout.count() > 0) arrived_.wait_for(lock, timeout, [this] { return value_.has_value(); });
    return std::exchange(value_, std::nullopt);
  }

  /// Values that were replaced before anybody took them.
  std::uint64_t dropped() const noexcept {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::optional<T> value_;
  std::uint64_t dropped_ = 0;
};

}  // namespace foresight
