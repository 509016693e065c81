#include "display/head/shared_picture.hpp"

namespace foresight::head {
namespace {

constexpr int kSlots = 3;
constexpr double kShownTimeout = 5;  // s

}  // namespace

SharedPicture::SharedPicture(int width, int height, const char* label) {
  for (int i = 0; i < kSlots; ++i) {
    gl::Texture texture(GL_RGBA8, width, height, 0, 1, label);
    TextureTarget target(texture.name(), width, height);
    slots_.push_back({std::move(texture), std::move(target), {}, {}, false});
  }
}

void SharedPicture::write(const std::function<void(const ViewTarget&)>& draw) {
  std::size_t free = 0;
  {
    const std::lock_guard lock(mutex_);
    while (static_cast<int>(free) == newest_ || static_cast<int>(free) == showing_) ++free;
  }
  Slot& slot = slots_[free];
  if (slot.was_shown) slot.shown.wait(kShownTimeout);  // long ago
  slot.was_shown = false;
  draw(slot.target.whole());
  gl::Fence drawn = gl::Fence::insert();
  const std::lock_guard lock(mutex_);
  slot.drawn = std::move(drawn);
  newest_ = static_cast<int>(free);
}

bool SharedPicture::fresh() const {
  const std::lock_guard lock(mutex_);
  return newest_ >= 0 && newest_ != showing_ && slots_[static_cast<std::size_t>(newest_)].drawn.signalled();
}

bool SharedPicture::show(const PictureCopy& copy, const ViewTarget& target) {
  const std::lock_guard lock(mutex_);
  if (newest_ >= 0 && slots_[static_cast<std::size_t>(newest_)].drawn.signalled()) showing_ = newest_;
  if (showing_ < 0) return false;
  Slot& slot = slots_[static_cast<std::size_t>(showing_)];
  copy(slot.texture, target);
  slot.shown = gl::Fence::insert();
  slot.was_shown = true;
  return true;
}

}  // namespace foresight::head
