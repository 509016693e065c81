// Move-only owners of OpenGL objects (direct state access, OpenGL 4.5).
//
// Create, use and destroy them on a thread where a context of their share group is current;
// vertex arrays, framebuffers and queries belong to the one context that created them.
#pragma once

#include <epoxy/gl.h>

#include <bit>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

namespace foresight::gl {

/// Owns one GL name; `Destroy` deletes it.
template <void (*Destroy)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint name) : name_(name) {}
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) reset(std::exchange(other.name_, 0));
    return *this;
  }
  ~Handle() { reset(0); }

  GLuint name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  void reset(GLuint name) {
    if (name_) Destroy(name_);
    name_ = name;
  }
  GLuint name_ = 0;
};

void delete_buffer(GLuint name);
void delete_texture(GLuint name);
void delete_framebuffer(GLuint name);
void delete_vertex_array(GLuint name);
void delete_query(GLuint name);
void delete_sampler(GLuint name);

using Framebuffer = Handle<delete_framebuffer>;
using VertexArray = Handle<delete_vertex_array>;
using Query = Handle<delete_query>;
using Sampler = Handle<delete_sampler>;

Framebuffer create_framebuffer(const char* label);
VertexArray create_vertex_array(const char* label);
/// Linear within a level and between them, clamped to edges.
Sampler create_level_sampler(const char* label);

/// A buffer of fixed size that may be written from the CPU at any time.
class Buffer : public Handle<delete_buffer> {
 public:
  Buffer() = default;
  /// At least `bytes`, rounded up to whole texels of any format; contents undefined; `label` shows up in GL debuggers.
  Buffer(std::size_t bytes, const char* label);

  std::size_t bytes() const { return bytes_; }

  /// Writes `data` at `offset`; it must fit.
  template <typename T>
  void write(std::span<const T> data, std::size_t offset = 0) {
    write_bytes(data.data(), data.size_bytes(), offset);
  }

  /// Waits for the GPU and reads the first data.size() elements.
  template <typename T>
  void read(std::span<T> data) const {
    read_bytes(data.data(), data.size_bytes());
  }

  void clear_to_zero();

 private:
  void write_bytes(const void* data, std::size_t bytes, std::size_t offset);
  void read_bytes(void* data, std::size_t bytes) const;
  std::size_t bytes_ = 0;
};

/// A texture with immutable storage.
class Texture : public Handle<delete_texture> {
 public:
  Texture() = default;
  /// 2-D texture, or 2-D array where `layers` > 0. Nearest filtering, clamped to the edge.
  Texture(GLenum format, int width, int height, int layers, int levels, const char* label);

  int width() const { return width_; }
  int height() const { return height_; }
  int layers() const { return layers_; }

 private:
  int width_ = 0, height_ = 0, layers_ = 0;
};

/// `size`, or `step` more where it is a power of two. Mesa's software renderer compiles programs anew where the size of
/// a texture becomes one, or is one no more: in the middle of operation, for what grows.
template <typename T>
constexpr T no_power_of_two(T size, T step) {
  return std::has_single_bit(static_cast<std::make_unsigned_t<T>>(size)) ? size + step : size;
}

/// A buffer seen by shaders as samplerBuffer: on software renderers a far cheaper gather than an SSBO.
class BufferTexture {
 public:
  BufferTexture() = default;
  BufferTexture(GLenum format, std::size_t bytes, const char* label);

  Buffer& buffer() { return buffer_; }
  const Buffer& buffer() const { return buffer_; }
  GLuint texture() const { return texture_.name(); }

  /// Makes room for `bytes` (contents are lost when it grows) and writes `data` to the front.
  template <typename T>
  void assign(std::span<const T> data) {
    reserve(data.size_bytes());
    if (!data.empty()) buffer_.write(data);
  }
  void reserve(std::size_t bytes);

 private:
  GLenum format_ = 0;
  const char* label_ = "";
  Buffer buffer_;
  Handle<delete_texture> texture_;
};

/// Marks a place in the command stream.
class Fence {
 public:
  Fence() = default;
  static Fence insert();  ///< after all commands so far; flushes
  Fence(Fence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}
  Fence& operator=(Fence&& other) noexcept;
  ~Fence();

  bool signalled() const;  ///< without waiting
  /// Blocks until the GPU has passed the fence; throws RuntimeFailure after `timeout_s`.
  void wait(double timeout_s) const;

 private:
  GLsync sync_ = nullptr;
};

}  // namespace foresight::gl
