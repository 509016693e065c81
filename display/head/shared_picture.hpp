// A picture that one thread draws and another one shows, each in its own context of one share group.
#pragma once

#include <array>
#include <functional>
#include <mutex>
#include <vector>

#include "display/view_target.hpp"

namespace foresight::head {

/// Neither waits for the other: who shows has the newest picture that the GPU has finished. Made and destroyed in the
/// writer's thread, its context current, the reader's thread having ended.
class SharedPicture {
 public:
  SharedPicture(int width, int height, const char* label);

  int width() const { return slots_[0].texture.width(); }
  int height() const { return slots_[0].texture.height(); }

  /// Writer: `draw` fills all of the target.
  void write(const std::function<void(const ViewTarget&)>& draw);

  /// Reader: there is a newer picture than the one that show() had last.
  bool fresh() const;
  /// Reader: fills `target` with the newest; false: there is none yet, and nothing was touched.
  bool show(const PictureCopy& copy, const ViewTarget& target);

 private:
  struct Slot {
    gl::Texture texture;
    TextureTarget target;  // of the writer's context
    gl::Fence drawn, shown;
    bool was_shown = false;
  };
  std::vector<Slot> slots_;
  mutable std::mutex mutex_;  // which is which; a slot that is neither is the writer's
  int newest_ = -1, showing_ = -1;
};

}  // namespace foresight::head
