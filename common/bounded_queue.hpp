// Values on their way from one thread to another, of which the newest count.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "common/time.hpp"

namespace foresight {

/// Holds `room` > 0 values; one that comes then replaces the oldest, which is counted. Any thread. `T` must be movable
/// without throwing.
template <typename T>
class BoundedQueue {
 public:
  /// `waits`: put() waits for room instead, for stepped time, where waiting costs nothing and nothing may be left out.
  explicit BoundedQueue(std::size_t room, bool waits = false) : room_(room), waits_(waits) {}

  void put(T value) noexcept {
    std::optional<T> oldest;  // goes without the lock
    {
      std::unique_lock lock(mutex_);
      if (waits_) taken_.wait(lock, [this] { return closed_ || values_.size() < room_; });
      if (closed_) return;
      if (values_.size() >= room_) {
        oldest = std::move(values_.front());
        values_.pop_front();
        ++dropped_;
      }
      values_.push_back(std::move(value));
    }
    arrived_.notify_one();
  }

  /// The oldest, waiting `timeout` at most.
  std::optional<T> take(Duration timeout) noexcept {
    std::optional<T> out;
    {
      std::unique_lock lock(mutex_);
      if (!has_any(lock, timeout)) return std::nullopt;
      out = std::move(values_.front());
      values_.pop_front();
    }
    taken_.notify_one();
    return out;
  }

  /// The newest; those before it count as dropped.
  std::optional<T> take_newest(Duration timeout) noexcept {
    std::deque<T> all;
    {
      std::unique_lock lock(mutex_);
      if (!has_any(lock, timeout)) return std::nullopt;
      all.swap(values_);
      dropped_ += all.size() - 1;
    }
    taken_.notify_one();
    return std::move(all.back());
  }

  /// Nothing comes any more: who waits wakes. What is in it can still be taken.
  void close() noexcept {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    arrived_.notify_all();
    taken_.notify_all();
  }
  bool closed() const noexcept {
    const std::lock_guard lock(mutex_);
    return closed_;
  }
  /// Values that went before anybody took them.
  std::uint64_t dropped() const noexcept {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  bool has_any(std::unique_lock<std::mutex>& lock, Duration timeout) {
    if (timeout.count() > 0) arrived_.wait_for(lock, timeout, [this] { return closed_ || !values_.empty(); });
    return !values_.empty();
  }

  const std::size_t room_;
  const bool waits_;
  mutable std::mutex mutex_;  // all below
  std::condition_variable arrived_, taken_;
  std::deque<T> values_;
  std::uint64_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace foresight
