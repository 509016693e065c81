// The newest value from one thread to another, where neither may wait.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace foresight {

/// Which of three slots is whose. One writer, one reader, of one process or, in memory that they share, of two.
/// Wait-free.
class TripleIndex {
 public:
  /// Writer: the slot that nobody else uses.
  std::size_t writing() const { return written_; }
  /// Writer: it is the newest now, and another one is to be written.
  void publish() {
    written_ = shared_.exchange(static_cast<std::uint8_t>(written_ | kNew), std::memory_order_acq_rel) & kIndex;
  }
  /// Reader: the newest is its own from here on. False: nothing was published since the last time.
  bool take() {
    if ((shared_.load(std::memory_order_relaxed) & kNew) == 0) return false;
    read_ = shared_.exchange(read_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  /// Reader: that of the last take().
  std::size_t reading() const { return read_; }

 private:
  static constexpr std::uint8_t kNew = 4, kIndex = 3;
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);
  std::atomic<std::uint8_t> shared_{0};
  std::uint8_t written_ = 1, read_ = 2;  // each index is always in exactly one of the three places
};

/// One writer, one reader. Values that were not taken in time are replaced. Wait-free; does not allocate if
/// copying a T does not.
template <typename T>
class TripleBuffer {
 public:
  /// Writer's thread.
  void put(const T& value) noexcept(noexcept(std::declval<T&>() = value)) {
    slots_[index_.writing()] = value;
    index_.publish();
  }
  /// Reader's thread: what was put since the last call, if anything.
  std::optional<T> take() {
    if (!index_.take()) return std::nullopt;
    return slots_[index_.reading()];
  }

 private:
  std::array<T, 3> slots_{};
  TripleIndex index_;
};

}  // namespace foresight
