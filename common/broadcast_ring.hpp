// Every value from one thread to several others, where the writer may not wait.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <type_traits>

namespace foresight {

/// One writer, any number of readers, each of which gets every value in order, unless it falls so far behind that the
/// writer has come around: then the oldest are dropped for that reader, and counted. The writer is wait-free and
/// knows nothing of its readers. Allocates only when made.
///
///   put -> | 8 | 9 | 2 | 3 | 4 | 5 | 6 | 7 |     capacity 8: a reader that has had 1 gets 2 next,
///                ^ newest                        one that has had none has missed 0 and 1
template <typename T>
class BroadcastRing {
  static_assert(std::is_trivially_copyable_v<T> && std::is_default_constructible_v<T>);

 public:
  /// `capacity` > 0: how many values a reader may be behind.
  explicit BroadcastRing(std::size_t capacity) : capacity_(capacity), slots_(std::make_unique<Slot[]>(capacity)) {}

  /// Writer's thread.
  void put(const T& value) noexcept {
    const std::uint64_t number = next_.load(std::memory_order_relaxed);
    Slot& slot = slots_[number % capacity_];
    Words words{};
    std::memcpy(words.data(), &value, sizeof value);
    slot.number.store(kInWork, std::memory_order_relaxed);
    // Each with release: who reads one of the new words finds the slot's number changed as well.
    for (std::size_t i = 0; i < kWords; ++i) slot.words[i].store(words[i], std::memory_order_release);
    slot.number.store(number, std::memory_order_release);
    next_.store(number + 1, std::memory_order_release);
  }

  /// One thread; the ring must outlive it.
  class Reader {
   public:
    /// The next value, if there is one.
    std::optional<T> take() noexcept {
      for (;;) {
        const std::uint64_t end = ring_->next_.load(std::memory_order_acquire);
        if (at_ == end) return std::nullopt;
        if (end - at_ > ring_->capacity_) {
          dropped_ += end - ring_->capacity_ - at_;
          at_ = end - ring_->capacity_;
        }
        T value;
        if (ring_->copy(at_, value)) {
          ++at_;
          return value;
        }
        // The writer came around meanwhile.
        ++at_;
        ++dropped_;
      }
    }
    /// Values that were replaced before this reader took them.
    std::uint64_t dropped() const noexcept { return dropped_; }

   private:
    friend class BroadcastRing;
    explicit Reader(const BroadcastRing& ring) : ring_(&ring), at_(ring.next_.load(std::memory_order_acquire)) {}
    const BroadcastRing* ring_;
    std::uint64_t at_, dropped_ = 0;
  };

  /// Gets what is put from now on. Any thread.
  Reader reader() const noexcept { return Reader(*this); }

 private:
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
  static constexpr std::uint64_t kInWork = ~std::uint64_t{0};
  using Words = std::array<std::uint64_t, kWords>;
  struct Slot {
    std::atomic<std::uint64_t> number{kInWork};  // of the value in it
    std::array<std::atomic<std::uint64_t>, kWords> words{};
  };

  /// False where the slot holds another value by now.
  bool copy(std::uint64_t number, T& value) const noexcept {
    const Slot& slot = slots_[number % capacity_];
    if (slot.number.load(std::memory_order_acquire) != number) return false;
    Words words;
    for (std::size_t i = 0; i < kWords; ++i) words[i] = slot.words[i].load(std::memory_order_acquire);
    if (slot.number.load(std::memory_order_relaxed) != number) return false;
    std::memcpy(&value, words.data(), sizeof value);
    return true;
  }

  std::size_t capacity_;
  std::unique_ptr<Slot[]> slots_;
  std::atomic<std::uint64_t> next_{0};
};

}  // namespace foresight
