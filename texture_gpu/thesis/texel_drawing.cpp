#include "texture_gpu/thesis/texel_drawing.hpp"

namespace foresight::gl {
const ShaderSources& thesis_shaders();
}  // namespace foresight::gl

namespace foresight::thesis {

const gl::ShaderSources& shaders() {
  static const gl::ShaderSources all = [] {
    gl::ShaderSources sources = gl::thesis_shaders();
    sources.insert(gl::gl_shaders().begin(), gl::gl_shaders().end());
    return sources;
  }();
  return all;
}

gl::Program texel_program(const char* fragment_shader, const std::vector<std::string>& defines) {
  return gl::Program::graphics(shaders(), "rectangle.vert", fragment_shader, defines);
}

TexelDrawing::TexelDrawing()
    : framebuffer_(gl::create_framebuffer("thesis texels")), no_vertices_(gl::create_vertex_array("no vertices")) {}

void TexelDrawing::onto(const gl::Texture& target, int width, int height) const {
  fences_();
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, target.name(), 0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, width, height);
}

void TexelDrawing::rectangle() const {
  glBindVertexArray(no_vertices_.name());
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

gl::Texture smooth_texture(GLenum format, int width, int height, const char* label) {
  gl::Texture texture(format, width, height, 0, 1, label);
  glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return texture;
}

}  // namespace foresight::thesis
