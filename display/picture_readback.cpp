#include "display/picture_readback.hpp"

#include "display/predicted_view.hpp"

namespace foresight {
namespace {

constexpr double kTimeout = 20;  // s

}  // namespace

bool PictureReadback::start(const gl::Texture& picture, const gl::Texture& doubt, RobotTime instant) {
  if (ways_.size() == kMost) return false;
  const std::size_t pixels = static_cast<std::size_t>(picture.width()) * static_cast<std::size_t>(picture.height());
  gl::Buffer buffer;
  if (!spare_.empty()) {
    buffer = std::move(spare_.back());
    spare_.pop_back();
  }
  if (buffer.bytes() < 5 * pixels) buffer = gl::Buffer(5 * pixels, "picture on its way");
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  // With a buffer bound, the pointer is a place in it.
  glGetTextureImage(picture.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(4 * pixels), nullptr);
  glGetTextureImage(doubt.name(), 0, GL_RED, GL_UNSIGNED_BYTE, static_cast<GLsizei>(pixels),
                    reinterpret_cast<void*>(4 * pixels));
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  ways_.push_back({instant, picture.width(), picture.height(), std::move(buffer), gl::Fence::insert()});
  return true;
}

std::optional<RememberedView> PictureReadback::take(bool wait) {
  if (ways_.empty() || (!wait && !ways_.front().end.signalled())) return std::nullopt;
  Way way = std::move(ways_.front());
  ways_.pop_front();
  if (wait) way.end.wait(kTimeout);
  RememberedView out{way.instant, cv::Mat(way.height, way.width, CV_8UC4), cv::Mat(way.height, way.width, CV_8UC1)};
  const auto pixels = static_cast<GLsizeiptr>(out.picture.total());
  glGetNamedBufferSubData(way.buffer.name(), 0, 4 * pixels, out.picture.data);
  glGetNamedBufferSubData(way.buffer.name(), 4 * pixels, pixels, out.doubt.data);
  spare_.push_back(std::move(way.buffer));
  PredictedView::count_as_seen(out.picture);
  return out;
}

}  // namespace foresight
