#include "gl/read_texture.hpp"

#include <stdexcept>

namespace foresight::gl {
namespace {

struct PixelForm {
  int cv_type;
  GLenum format, type;
};

PixelForm form_of(GLint internal_format) {
  switch (internal_format) {
    case GL_RGBA8:
    case GL_SRGB8_ALPHA8: return {CV_8UC4, GL_RGBA, GL_UNSIGNED_BYTE};
    case GL_R8: return {CV_8UC1, GL_RED, GL_UNSIGNED_BYTE};
    case GL_R32F: return {CV_32FC1, GL_RED, GL_FLOAT};
    case GL_DEPTH_COMPONENT32F: return {CV_32FC1, GL_DEPTH_COMPONENT, GL_FLOAT};
    case GL_R32UI: return {CV_32SC1, GL_RED_INTEGER, GL_UNSIGNED_INT};
    default: throw std::invalid_argument("read_texture: a format that nobody has asked for yet");
  }
}

}  // namespace

cv::Mat read_texture(GLuint name) {
  GLint width = 0, height = 0, internal_format = 0;
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_WIDTH, &width);
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_HEIGHT, &height);
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_INTERNAL_FORMAT, &internal_format);
  const PixelForm form = form_of(internal_format);
  cv::Mat out(height, width, form.cv_type);
  glGetTextureImage(name, 0, form.format, form.type, static_cast<GLsizei>(out.total() * out.elemSize()), out.data);
  return out;
}

}  // namespace foresight::gl
