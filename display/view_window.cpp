#include "display/view_window.hpp"

#include <chrono>

namespace foresight {
namespace {

constexpr int kGap = 6;  // px between the pictures

}  // namespace

ViewTarget window_target(const gl::Window& window) {
  ViewTarget target;
  window.framebuffer_size(target.width, target.height);
  return target;
}

void clear_behind_pictures(const ViewTarget& target, bool fault) {
  fault ? fill(target, 0.75f, 0.08f, 0.08f) : fill(target, 0.12f, 0.13f, 0.15f);
}

ViewWindow::ViewWindow(gl::Window& window, ViewWindowOptions options)
    : window_(window), options_(std::move(options)), delayed_("delayed picture"), actual_("actual picture") {}

void ViewWindow::arrived(const PosedFrame& frame) {
  delayed_.upload(frame.left.pixels);
}

void ViewWindow::stepped(const ViewStep& step, FrameSource& source, ViewSession& session) {
  if (!step.drawn) return;
  drawn_ = true;
  if (options_.actual) actual_.upload(source.actual());
  if (options_.title) title_ = options_.title(step);
  if (!title_.empty()) window_.set_title(title_);
  fault_.clear();
  present(&session.picture(), false);
}

void ViewWindow::waiting(FrameSource& source, ViewSession& session) {
  const std::string fault = source.fault();
  if (fault != fault_) window_.set_title(fault.empty() ? title_ : fault);
  fault_ = fault;
  const cv::Mat image = drawn_ ? cv::Mat() : source.unposed();
  if (!image.empty()) delayed_.upload(image);
  present(drawn_ ? &session.picture() : nullptr, !fault.empty() && image.empty());
}

void ViewWindow::present(const gl::Texture* predicted, bool fault) {
  const ViewTarget whole = window_target(window_);
  clear_behind_pictures(whole, fault);
  const int count = options_.actual ? 3 : 2;
  const auto show = [&](const gl::Texture& picture, int place) {
    copy_(picture, fitted(column(whole, place, count, kGap), picture.width(), picture.height()));
  };
  if (!delayed_.empty()) show(delayed_.texture(), 0);
  if (predicted) show(*predicted, 1);
  if (options_.actual && !actual_.empty()) show(actual_.texture(), 2);
  window_.present();
}

void ViewWindow::linger(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end && !window_.should_close()) window_.wait_events(0.05);
}

}  // namespace foresight
