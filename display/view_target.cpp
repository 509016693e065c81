#include "display/view_target.hpp"

#include <algorithm>

namespace foresight {

ViewTarget fitted(const ViewTarget& target, int width, int height) {
  const double scale = std::min(target.width / static_cast<double>(width), target.height / static_cast<double>(height));
  ViewTarget out = target;
  out.width = std::max(1, static_cast<int>(width * scale));
  out.height = std::max(1, static_cast<int>(height * scale));
  out.x += (target.width - out.width) / 2;
  out.y += (target.height - out.height) / 2;
  return out;
}

ViewTarget column(const ViewTarget& target, int index, int count, int gap) {
  ViewTarget out = target;
  out.width = std::max(1, (target.width - (count + 1) * gap) / count);
  out.height = std::max(1, target.height - 2 * gap);
  out.x += gap + index * (out.width + gap);
  out.y += gap;
  return out;
}

TextureTarget::TextureTarget(GLuint texture, int width, int height, int layer, bool first_row_at_top)
    : framebuffer_(gl::create_framebuffer("view target")), whole_{framebuffer_.name(), 0, 0, width, height,
                                                                  first_row_at_top} {
  if (layer < 0)
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, texture, 0);
  else
    glNamedFramebufferTextureLayer(framebuffer_.name(), GL_COLOR_ATTACHMENT0, texture, 0, layer);
}

PictureCopy::PictureCopy() : source_(gl::create_framebuffer("picture to copy")) {}

void PictureCopy::operator()(const gl::Texture& picture, const ViewTarget& target, int columns) const {
  const int width = columns > 0 ? columns : picture.width();
  glNamedFramebufferTexture(source_.name(), GL_COLOR_ATTACHMENT0, picture.name(), 0);
  const int top = target.first_row_at_top ? target.y : target.y + target.height;
  const int bottom = target.first_row_at_top ? target.y + target.height : target.y;
  const bool same = width == target.width && picture.height() == target.height;
  glBlitNamedFramebuffer(source_.name(), target.framebuffer, 0, 0, width, picture.height(), target.x, top,
                         target.x + target.width, bottom, GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
  glNamedFramebufferTexture(source_.name(), GL_COLOR_ATTACHMENT0, 0, 0);  // the picture may go before this
}

void fill(const ViewTarget& target, float red, float green, float blue) {
  const float colour[4] = {red, green, blue, 1};
  glEnable(GL_SCISSOR_TEST);
  glScissor(target.x, target.y, target.width, target.height);
  glClearNamedFramebufferfv(target.framebuffer, GL_COLOR, 0, colour);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace foresight
