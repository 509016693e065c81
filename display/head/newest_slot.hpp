// What one thread makes and another one shows, each in its own OpenGL context of one share group.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>

#include "gl/objects.hpp"

namespace foresight::head {

/// Three of a kind: the reader's, the newest, and one for the writer. Neither waits for the other.
template <typename T>
class NewestSlot {
 public:
  /// Writer: one that nobody else uses. The GPU has finished what was shown of it.
  std::optional<T>& begin() {
    std::size_t free = 0;
    {
      const std::lock_guard lock(mutex_);
      while (static_cast<int>(free) == newest_ || static_cast<int>(free) == showing_) ++free;
    }
    Slot& slot = slots_[free];
    writing_ = free;
    if (slot.was_shown) slot.shown.wait(kShownTimeout);  // long ago
    slot.was_shown = false;
    return slot.value;
  }
  /// Writer: all commands that make it are given.
  void end() {
    gl::Fence drawn = gl::Fence::insert();
    const std::lock_guard lock(mutex_);
    slots_[writing_].drawn = std::move(drawn);
    newest_ = static_cast<int>(writing_);
  }

  /// Reader: there is a newer one than that of the last newest().
  bool fresh() const {
    const std::lock_guard lock(mutex_);
    return newest_ >= 0 && newest_ != showing_ && slots_[static_cast<std::size_t>(newest_)].drawn.signalled();
  }
  /// Reader: the newest that the GPU has finished; the reader's until the next call. Null: there is none yet.
  const T* newest() {
    const std::lock_guard lock(mutex_);
    if (newest_ >= 0 && slots_[static_cast<std::size_t>(newest_)].drawn.signalled()) showing_ = newest_;
    return showing_ < 0 ? nullptr : &*slots_[static_cast<std::size_t>(showing_)].value;
  }
  /// Reader: all commands that read it so far are given.
  void shown() {
    const std::lock_guard lock(mutex_);
    if (showing_ < 0) return;
    Slot& slot = slots_[static_cast<std::size_t>(showing_)];
    slot.shown = gl::Fence::insert();
    slot.was_shown = true;
  }

 private:
  static constexpr double kShownTimeout = 5;  // s
  struct Slot {
    std::optional<T> value;
    gl::Fence drawn, shown;
    bool was_shown = false;
  };
  std::array<Slot, 3> slots_;
  std::size_t writing_ = 0;
  mutable std::mutex mutex_;  // which is which; a slot that is neither is the writer's
  int newest_ = -1, showing_ = -1;
};

}  // namespace foresight::head
