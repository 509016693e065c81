// Drawn pictures on their way to the CPU, without anybody waiting for the GPU.
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "gl/objects.hpp"

namespace foresight {

/// What was shown for an instant.
struct RememberedView {
  RobotTime instant;
  cv::Mat picture;  ///< CV_8UC4, BGRA as PredictedView has it
  cv::Mat doubt;    ///< CV_8UC1 of the same size (doubt_kinds.hpp)
};

/// Belongs to one context.
class PictureReadback {
 public:
  /// Asks for both as they will be once the commands so far are done. False: too many are on their way, this one is
  /// left out. `picture`: RGBA8; `doubt`: R8 of the same size.
  bool start(const gl::Texture& picture, const gl::Texture& doubt, RobotTime instant);
  /// The oldest that is complete. With `wait`: the oldest, as soon as it is; throws RuntimeFailure where the GPU hangs.
  std::optional<RememberedView> take(bool wait = false);

 private:
  static constexpr std::size_t kMost = 4;
  struct Way {
    RobotTime instant;
    int width = 0, height = 0;
    gl::Buffer buffer;
    gl::Fence end;
  };
  std::deque<Way> ways_;
  std::vector<gl::Buffer> spare_;
};

}  // namespace foresight
