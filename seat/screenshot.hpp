// Pictures of the seat's window for whoever asks for one, while the robot moves.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>

namespace foresight {

/// Which file it went into, and why not; "" where it was written.
struct Screenshot {
  std::filesystem::path file;
  std::string trouble;
};

/// Writes `picture` (CV_8UC3) into the first of foresight-001.png, foresight-002.png, ... that `folder` ("": the
/// working one) does not have; whatever another program puts there meanwhile stays as it is. Does not throw: nobody
/// stops driving for want of a picture. Blocks as the disk does.
Screenshot save_screenshot(const std::filesystem::path& folder, const cv::Mat& picture) noexcept;

/// The same in a thread of its own: a window that waits for a disk lets go of a switch. One thread.
class ScreenshotWriter {
 public:
  static constexpr std::size_t kRoom = 4;  ///< pictures that wait

  explicit ScreenshotWriter(std::filesystem::path folder);
  /// finish()
  ~ScreenshotWriter();
  ScreenshotWriter(const ScreenshotWriter&) = delete;
  ScreenshotWriter& operator=(const ScreenshotWriter&) = delete;

  /// Is written soon; `rows_from_below`, as OpenGL reads them, is this thread's no longer. False: kRoom others wait.
  bool take(cv::Mat rows_from_below);
  /// What became of the next one that was taken; nothing while it is not known.
  std::optional<Screenshot> done();
  /// Waits until all that was taken is written, or is known not to be.
  void finish();

 private:
  void write(const std::stop_token& stop);

  const std::filesystem::path folder_;
  std::mutex mutex_;  // all below
  std::condition_variable_any wanted_, written_;
  std::deque<cv::Mat> waiting_;
  std::deque<Screenshot> done_;
  bool writing_ = false;
  std::jthread thread_;  // the last: joined before all else goes
};

}  // namespace foresight
