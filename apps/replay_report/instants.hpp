// Pictures of a few instants of a run, kept small for the contact sheet and the HTML report.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "apps/replay_report/replay_report.hpp"

namespace foresight {

/// One instant, ready to be looked at. Pictures are CV_8UC3 (BGR), all of one size.
struct Instant {
  FrameRecord frame;
  cv::Mat delayed;
  cv::Mat predicted;  ///< composed over neutral dark: what has no colour stays calm
  cv::Mat actual;
  cv::Mat error;  ///< error_picture()
};

/// Largest difference of the three channels on seen pixels, as a colour from dark (none) to bright
/// (kErrorRange levels and more); filled holes hatched; neutral dark where there is no colour.
/// `predicted`: CV_8UC4; `actual`: CV_8UC3 of the same size; else std::invalid_argument.
inline constexpr double kErrorRange = 64;
cv::Mat error_picture(const cv::Mat& predicted, const cv::Mat& actual);

/// Colour of a difference of `share` in [0, 1] of kErrorRange (BGR).
cv::Vec3b error_colour(double share);

inline const cv::Vec3b kNoModelColour{38, 34, 31};     ///< BGR, alpha 0
inline const cv::Vec3b kUncolouredColour{62, 56, 52};  ///< BGR, model without any colour
inline const cv::Vec3b kFilledColour{120, 104, 78};    ///< BGR, the hatch of filled holes

/// Scales the pictures to at most `max_width` px. Types as for error_picture(); `delayed` CV_8UC3.
Instant make_instant(const FrameRecord& frame, const cv::Mat& delayed, const cv::Mat& predicted, const cv::Mat& actual,
                     int max_width);

/// Keeps instants that are spread evenly over a run of unknown length, so that an interrupted run
/// has pictures too. It keeps every `stride`-th instant that is offered; when it holds twice as many
/// as wanted, every second one goes and the stride doubles. One thread.
class InstantKeeper {
 public:
  explicit InstantKeeper(std::size_t wanted = 4, int max_width = 960);

  /// Cheap unless this instant is kept. Pixels are copied.
  void offer(const FrameRecord& frame, const cv::Mat& delayed, const cv::Mat& predicted, const cv::Mat& actual);

  /// The wanted number of instants (or as many as there are), in time order, spread evenly.
  std::vector<Instant> instants() const;

 private:
  std::size_t wanted_, stride_ = 1, offered_ = 0;
  int max_width_;
  std::vector<Instant> kept_;
};

}  // namespace foresight
