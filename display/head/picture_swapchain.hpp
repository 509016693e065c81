// Pictures that an OpenXR runtime lends us to draw into, one after the other.
#pragma once

#include <vector>

#include "display/head/xr_calls.hpp"
#include "display/view_target.hpp"

namespace foresight::head {

/// sRGB, 8 bits a channel, with alpha: what our pictures hold. Throws CallFailed where the runtime has none.
std::int64_t picture_format(XrSession session);

/// Belongs to the session and to the context that it was made with; goes before both.
class PictureSwapchain {
 public:
  /// Throws CallFailed.
  PictureSwapchain(XrSession session, std::int64_t format, int width, int height);
  ~PictureSwapchain();
  PictureSwapchain(const PictureSwapchain&) = delete;
  PictureSwapchain& operator=(const PictureSwapchain&) = delete;

  /// The next picture, once nobody looks at it any more; contents undefined. Throws CallFailed, also where that takes
  /// longer than a second.
  const ViewTarget& acquire();
  /// It is drawn, as far as commands go. Throws CallFailed.
  void release();
  /// Some picture was released: layers may show it.
  bool filled() const { return filled_; }

  int width() const { return width_; }
  int height() const { return height_; }
  XrSwapchainSubImage whole() const;

 private:
  XrSwapchain swapchain_ = XR_NULL_HANDLE;
  int width_, height_;
  std::vector<TextureTarget> targets_;
  bool filled_ = false;
};

}  // namespace foresight::head
