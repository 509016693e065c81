#include "display/head/shared_picture.hpp"

namespace foresight::head {

SharedPicture::SharedPicture(int width, int height, const char* label)
    : width_(width), height_(height), label_(label) {}

void SharedPicture::write(const std::function<void(const ViewTarget&)>& draw) {
  auto& slot = slots_.begin();
  if (!slot) {
    gl::Texture texture(GL_RGBA8, width_, height_, 0, 1, label_);
    TextureTarget target(texture.name(), width_, height_);
    slot.emplace(Picture{std::move(texture), std::move(target)});
  }
  draw(slot->target.whole());
  slots_.end();
}

bool SharedPicture::show(const PictureCopy& copy, const ViewTarget& target) {
  const Picture* const picture = slots_.newest();
  if (!picture) return false;
  copy(picture->texture, target);
  slots_.shown();
  return true;
}

}  // namespace foresight::head
