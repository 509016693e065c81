// A window beside a view: what the camera saw a while ago, the predicted view, and the camera's own image.
#pragma once

#include <functional>
#include <string>

#include "display/uploaded_picture.hpp"
#include "display/view_loop.hpp"
#include "display/view_target.hpp"
#include "gl/glfw_window.hpp"

namespace foresight {

struct ViewWindowOptions {
  bool actual = false;  ///< a third picture: what the camera saw at the shown instant
  /// Asked after each step. Empty: the title stays.
  std::function<std::string(const ViewStep&)> title = {};
};

/// Belongs to the window's context. While the source has a fault, the title tells it. The frame around the pictures is
/// red then, as what is shown is old; but not before the first view, while images that only lack a pose are shown.
class ViewWindow final : public ViewObserver {
 public:
  /// `window` must outlive this.
  ViewWindow(gl::Window& window, ViewWindowOptions options);

  void arrived(const PosedFrame& frame) override;
  void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) override;
  void waiting(FrameSource& source, ViewSession& session) override;
  bool wants_more() const override { return !window_.should_close(); }

  /// Leaves the window as it is for a while, or until the user closes it.
  void linger(double seconds);

 private:
  void present(const gl::Texture* predicted, bool fault);

  gl::Window& window_;
  ViewWindowOptions options_;
  PictureCopy copy_;
  UploadedPicture delayed_, actual_;
  bool drawn_ = false;  // there is a view
  std::string fault_;   // that the title tells
  std::string title_;
};

/// The whole of a window.
ViewTarget window_target(const gl::Window& window);

/// Fills it with what lies behind pictures: calm grey; red where they are not to be trusted.
void clear_behind_pictures(const ViewTarget& target, bool fault = false);

}  // namespace foresight
