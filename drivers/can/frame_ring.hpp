// A queue of frames with room for a fixed number.
#pragma once

#include <vector>

#include "drivers/can/can_frame.hpp"

namespace foresight {

/// First in, first out. Allocates only when made. One thread, or locked outside.
class FrameRing {
 public:
  explicit FrameRing(std::size_t capacity) : frames_(capacity) {}

  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  const CanFrame& front() const { return frames_[first_]; }  ///< not of an empty one
  /// False where there is no room.
  bool push(const CanFrame& frame) {
    if (count_ == frames_.size()) return false;
    frames_[(first_ + count_++) % frames_.size()] = frame;
    return true;
  }
  CanFrame pop() {  ///< not of an empty one
    const std::size_t at = first_;
    first_ = (first_ + 1) % frames_.size();
    --count_;
    return frames_[at];
  }
  void clear() { first_ = count_ = 0; }

 private:
  std::vector<CanFrame> frames_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace foresight
