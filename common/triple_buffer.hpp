// The newest value from one thread to another, where neither may wait.
#pragma once

#include <array>
#include <atomic>
#include <optional>

namespace foresight {

/// One writer, one reader. Values that were not taken in time are replaced. Wait-free; does not allocate if
/// copying a T does not.
template <typename T>
class TripleBuffer {
 public:
  /// Writer's thread.
  void put(const T& value) noexcept(noexcept(std::declval<T&>() = value)) {
    slots_[written_] = value;
    written_ = shared_.exchange(static_cast<std::uint8_t>(written_ | kNew), std::memory_order_acq_rel) & kIndex;
  }
  /// Reader's thread: what was put since the last call, if anything.
  std::optional<T> take() {
    if ((shared_.load(std::memory_order_relaxed) & kNew) == 0) return std::nullopt;
    read_ = shared_.exchange(read_, std::memory_order_acq_rel) & kIndex;
    return slots_[read_];
  }

 private:
  static constexpr std::uint8_t kNew = 4, kIndex = 3;
  std::array<T, 3> slots_{};
  std::atomic<std::uint8_t> shared_{0};
  std::uint8_t written_ = 1, read_ = 2;  // each index is always in exactly one of the three places
};

}  // namespace foresight
