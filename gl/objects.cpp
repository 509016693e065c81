#include "gl/objects.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace foresight::gl {

void delete_buffer(GLuint name) {
  glDeleteBuffers(1, &name);
}
void delete_texture(GLuint name) {
  glDeleteTextures(1, &name);
}
void delete_framebuffer(GLuint name) {
  glDeleteFramebuffers(1, &name);
}
void delete_vertex_array(GLuint name) {
  glDeleteVertexArrays(1, &name);
}
void delete_query(GLuint name) {
  glDeleteQueries(1, &name);
}
void delete_sampler(GLuint name) {
  glDeleteSamplers(1, &name);
}

namespace {

GLuint create_buffer_name() {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  return name;
}

GLuint create_texture_name(GLenum target) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  return name;
}

constexpr std::size_t kTexel = 16;  // bytes, of the largest format

/// At least one, whatever their format.
std::size_t whole_texels(std::size_t bytes) {
  return (std::max<std::size_t>(bytes, 1) + kTexel - 1) / kTexel * kTexel;
}

}  // namespace

Framebuffer create_framebuffer(const char* label) {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  glObjectLabel(GL_FRAMEBUFFER, name, -1, label);
  return Framebuffer(name);
}

VertexArray create_vertex_array(const char* label) {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  glObjectLabel(GL_VERTEX_ARRAY, name, -1, label);
  return VertexArray(name);
}

Sampler create_level_sampler(const char* label) {
  GLuint name = 0;
  glCreateSamplers(1, &name);
  glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glSamplerParameteri(name, wrap, GL_CLAMP_TO_EDGE);
  glObjectLabel(GL_SAMPLER, name, -1, label);
  return Sampler(name);
}

Buffer::Buffer(std::size_t bytes, const char* label)
    : Handle<delete_buffer>(create_buffer_name()), bytes_(whole_texels(bytes)) {
  glNamedBufferStorage(name(), static_cast<GLsizeiptr>(bytes_), nullptr, GL_DYNAMIC_STORAGE_BIT);
  glObjectLabel(GL_BUFFER, name(), -1, label);
}

void Buffer::write_bytes(const void* data, std::size_t bytes, std::size_t offset) {
  if (bytes) glNamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::read_bytes(void* data, std::size_t bytes) const {
  if (bytes) glGetNamedBufferSubData(name(), 0, static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::clear_to_zero() {
  glClearNamedBufferData(name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
}

Texture::Texture(GLenum format, int width, int height, int layers, int levels, const char* label)
    : Handle<delete_texture>(create_texture_name(layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D)),
      width_(width),
      height_(height),
      layers_(layers) {
  if (layers > 0)
    glTextureStorage3D(name(), levels, format, width, height, layers);
  else
    glTextureStorage2D(name(), levels, format, width, height);
  // Of one level, too: one sampler state for all of them (sampler_reset.hpp).
  glTextureParameteri(name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
  glTextureParameteri(name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTextureParameteri(name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glObjectLabel(GL_TEXTURE, name(), -1, label);
}

BufferTexture::BufferTexture(GLenum format, std::size_t bytes, const char* label) : format_(format), label_(label) {
  reserve(bytes);
}

void BufferTexture::reserve(std::size_t bytes) {
  if (buffer_ && bytes <= buffer_.bytes()) return;
  // Grown in steps of a half, so that a slowly growing list is not reallocated for every image.
  buffer_ = Buffer(no_power_of_two(whole_texels(std::max(bytes, buffer_.bytes() * 3 / 2)), kTexel), label_);
  texture_ = Handle<delete_texture>(create_texture_name(GL_TEXTURE_BUFFER));
  glTextureBuffer(texture_.name(), format_, buffer_.name());
}

Fence Fence::insert() {
  Fence fence;
  fence.sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();
  return fence;
}

Fence& Fence::operator=(Fence&& other) noexcept {
  if (this != &other) {
    if (sync_) glDeleteSync(sync_);
    sync_ = std::exchange(other.sync_, nullptr);
  }
  return *this;
}

Fence::~Fence() {
  if (sync_) glDeleteSync(sync_);
}

bool Fence::signalled() const {
  if (!sync_) return true;
  const GLenum status = glClientWaitSync(sync_, 0, 0);
  return status == GL_ALREADY_SIGNALED || status == GL_CONDITION_SATISFIED;
}

void Fence::wait(double timeout_s) const {
  if (!sync_) return;
  const auto timeout_ns = static_cast<GLuint64>(timeout_s * 1e9);
  const GLenum status = glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, timeout_ns);
  if (status != GL_ALREADY_SIGNALED && status != GL_CONDITION_SATISFIED)
    throw RuntimeFailure("the GPU did not finish an image within " + std::to_string(timeout_s) + " s",
                         "look for a GPU fault with `dmesg`, or lower --texture-memory-mb");
}

}  // namespace foresight::gl
