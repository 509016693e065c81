// A number that a pass counts, told a while later: nobody waits for it.
#pragma once

#include <cstdint>

#include "gl/objects.hpp"

namespace foresight {

/// Belongs to one context.
class GpuCount {
 public:
  explicit GpuCount(const char* label) : buffer_(sizeof(GLuint), label) {}

  /// A pass begins, which adds to the first word of the shader storage buffer at `binding`. Takes in what the pass
  /// before has counted, where the GPU has finished that.
  void start(GLuint binding);
  /// Its commands are given.
  void finish();

  /// Of a pass before the last one; 0 at first.
  std::uint32_t value() const { return value_; }

 private:
  gl::Buffer buffer_;
  gl::Fence counted_;
  bool counts_ = false;
  std::uint32_t value_ = 0;
};

}  // namespace foresight
