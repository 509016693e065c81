#include "texture_gpu/work_list.hpp"

#include <array>

namespace foresight {
namespace {

constexpr std::size_t kHeader = 8 * sizeof(GLuint);

}  // namespace

WorkList::WorkList(unsigned x0, unsigned x1, const char* label) : x0_(x0), x1_(x1), buffer_(GL_R32UI, 4096, label) {}

void WorkList::start(std::size_t most) {
  buffer_.reserve(kHeader + most * sizeof(GLuint));
  const std::array<GLuint, 8> header{x0_, 0, 0, 0, x1_, 0, 0, 0};
  buffer_.buffer().write(std::span<const GLuint>(header));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffer_.buffer().name());
}

void WorkList::finish() const {
  // The last bit is for the next start(), which writes the header again.
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindTextureUnit(15, buffer_.texture());
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer_.buffer().name());
}

void WorkList::dispatch(int way) const {
  glDispatchComputeIndirect(static_cast<GLintptr>(way) * 4 * sizeof(GLuint));
}

}  // namespace foresight
