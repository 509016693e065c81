#include "display/warp/gpu_count.hpp"

#include <span>

namespace foresight {

void GpuCount::start(GLuint binding) {
  if (counts_ && counted_.signalled()) buffer_.read(std::span(&value_, 1));
  buffer_.clear_to_zero();
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer_.name());
}

void GpuCount::finish() {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  counted_ = gl::Fence::insert();
  counts_ = true;
}

}  // namespace foresight
