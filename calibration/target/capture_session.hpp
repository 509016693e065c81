// Pairs of images in, a folder of views worth solving out.
#pragma once

#include <filesystem>

#include "calibration/target/capture_guide.hpp"

namespace foresight {

/// One thread. Images of one size per camera, 8 bit, colours or grey.
class CaptureSession {
 public:
  struct Options {
    std::filesystem::path out;       ///< gets left/NNN.png and right/NNN.png, NNN from 001
    std::filesystem::path pictures;  ///< gets now.png, what the user should see; empty: none
    CaptureGuide::Options guide;
  };

  /// Makes the folders. Throws InputError where `out` already holds views: two boards in one set ruin both.
  CaptureSession(const Board& board, const Options& options);

  /// Finds the board in both, judges, and writes what is taken. A ChArUco board's dictionary is
  /// found from the first images that show it. Throws RuntimeFailure where an image cannot be
  /// written, InputError where the size changes.
  CaptureGuide::Verdict show(const cv::Mat& left, const cv::Mat& right);

  const CaptureGuide* guide() const { return guide_ ? &*guide_ : nullptr; }  ///< null before the first pair
  const Board& board() const { return board_; }

 private:
  Board board_;
  Options options_;
  std::optional<BoardFinder> finder_;
  std::optional<CaptureGuide> guide_;
  cv::Size size_;
};

/// The image with the found points, the parts not seen yet, the uncertainty so far (bar and map) and
/// the words of the guide.
cv::Mat capture_picture(const cv::Mat& image, const std::optional<FoundBoard>& found, const CaptureGuide& guide,
                        const CaptureGuide::Verdict& verdict);

}  // namespace foresight
