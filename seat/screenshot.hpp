// Pictures of the seat's window for whoever asks for one, while the robot moves.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace foresight {

/// Which file it went into, and why not; "" where it was written.
struct Screenshot {
  std::filesystem::path file;
  std::string trouble;
};

/// Writes `picture` (CV_8UC3) into the first of foresight-001.png, foresight-002.png, ... that `folder` ("": the
/// working one) does not have. Does not throw: nobody stops driving for want of a picture. Blocks as the disk does.
Screenshot save_screenshot(const std::filesystem::path& folder, const cv::Mat& picture) noexcept;

}  // namespace foresight
