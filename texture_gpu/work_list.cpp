#include "texture_gpu/work_list.hpp"

#include <array>

#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

constexpr std::size_t kHeader = 4 * sizeof(GLuint);

}  // namespace

WorkList::WorkList(const char* label, std::size_t words_per_item)
    : bytes_per_item_(words_per_item * sizeof(GLuint)),
      args_(gl::Program::compute(gl::texture_gpu_shaders(), "work_args.comp")),
      buffer_(GL_R32UI, 4096, label) {}

void WorkList::start(std::size_t most) {
  buffer_.reserve(kHeader + most * bytes_per_item_);
  const std::array<GLuint, 4> header{1, 0, 0, 0};
  buffer_.buffer().write(std::span<const GLuint>(header));
  bind();
}

void WorkList::bind(unsigned block) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, block, buffer_.buffer().name());
}

void WorkList::finish(const gl::Program& by, unsigned unit, unsigned invocations) const {
  finish(by.invocations() / invocations, unit);
}

void WorkList::finish_for_groups(unsigned unit) const {
  finish(std::size_t{1}, unit);
}

void WorkList::finish(std::size_t items_per_group, unsigned unit) const {
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  bind();
  args_.set("items_per_group", static_cast<GLuint>(items_per_group));
  args_.dispatch(1);
  // The last bit is for the next start(), which writes the header again.
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindTextureUnit(unit, buffer_.texture());
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer_.buffer().name());
}

void WorkList::dispatch(const gl::Program& program) const {
  program.use();
  glDispatchComputeIndirect(0);
}

}  // namespace foresight
