// Hands out numbered slots of a store.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "texture_gpu/atlas_layout.hpp"

namespace foresight {

/// One thread. Slots come lowest first on a fresh pool, so that runs are repeatable.
class SlotPool {
 public:
  explicit SlotPool(std::uint32_t capacity) : capacity_(capacity) {}

  std::uint32_t capacity() const { return capacity_; }
  std::uint32_t free() const { return capacity_ - next_ + static_cast<std::uint32_t>(returned_.size()); }
  std::uint32_t used() const { return capacity_ - free(); }
  /// All slots taken so far, and those that the next `more` will be, lie below this one.
  std::uint32_t reach(std::size_t more) const {
    return next_ + static_cast<std::uint32_t>(
                       std::min<std::size_t>(more - std::min(more, returned_.size()), capacity_ - next_));
  }
  /// From now on there are no more than `capacity`, or than were taken already.
  void limit(std::uint32_t capacity) { capacity_ = std::clamp(capacity, next_, capacity_); }

  /// A slot that nobody holds; kNoSlot where none is free.
  std::uint32_t take() {
    if (!returned_.empty()) {
      const std::uint32_t slot = returned_.back();
      returned_.pop_back();
      return slot;
    }
    return next_ < capacity_ ? next_++ : atlas::kNoSlot;
  }
  void give_back(std::uint32_t slot) { returned_.push_back(slot); }

 private:
  std::uint32_t capacity_;
  std::uint32_t next_ = 0;
  std::vector<std::uint32_t> returned_;
};

}  // namespace foresight
