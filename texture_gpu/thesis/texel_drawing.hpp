// Drawing texel by texel: the orthographic projection M_t of eq. 4.23, one texel to one pixel.
#pragma once

#include "gl/kept_fences.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace foresight::thesis {

/// All shaders of the pipeline, and those of gl/.
const gl::ShaderSources& shaders();

/// A program that runs for every texel of a rectangle.
gl::Program texel_program(const char* fragment_shader, const std::vector<std::string>& defines = {});

/// Draws rectangles into textures. Belongs to one context.
class TexelDrawing {
 public:
  TexelDrawing();

  /// The next drawing goes into the first `width` x `height` texels of `target`.
  void onto(const gl::Texture& target, int width, int height) const;

  /// Runs the current program for every texel there.
  void rectangle() const;

 private:
  gl::Framebuffer framebuffer_;
  gl::VertexArray no_vertices_;
  gl::KeptFences fences_;
};

/// A texture that is sampled with bilinear interpolation.
gl::Texture smooth_texture(GLenum format, int width, int height, const char* label);

}  // namespace foresight::thesis
