// A picture that one thread draws and another one shows, each in its own context of one share group.
#pragma once

#include <functional>

#include "display/head/newest_slot.hpp"
#include "display/view_target.hpp"

namespace foresight::head {

/// Neither waits for the other: who shows has the newest picture that the GPU has finished. Made and destroyed in the
/// writer's thread, its context current, the reader's thread having ended.
class SharedPicture {
 public:
  SharedPicture(int width, int height, const char* label);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Writer: `draw` fills all of the target.
  void write(const std::function<void(const ViewTarget&)>& draw);

  /// Reader: there is a newer picture than the one that show() had last.
  bool fresh() const { return slots_.fresh(); }
  /// Reader: fills `target` with the newest; false: there is none yet, and nothing was touched.
  bool show(const PictureCopy& copy, const ViewTarget& target);

 private:
  struct Picture {
    gl::Texture texture;
    TextureTarget target;  // of the writer's context
  };
  int width_, height_;
  const char* label_;
  NewestSlot<Picture> slots_;
};

}  // namespace foresight::head
