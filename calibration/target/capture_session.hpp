// Images in, of one camera or of a pair; a folder of views worth solving out.
#pragma once

#include <filesystem>

#include "calibration/target/capture_guide.hpp"

namespace foresight {

/// One thread. Images of one size per camera, 8 bit, colours or grey.
class CaptureSession {
 public:
  struct Options {
    std::filesystem::path out;  ///< gets left/NNN.png and right/NNN.png, of one camera NNN.png; NNN from 001
    bool stereo = true;
    CaptureGuide::Options guide;
  };

  /// What an image, or a pair, was worth.
  struct Outcome {
    std::array<std::optional<FoundBoard>, 2> found;  ///< of the left (or only) and the right image
    CaptureGuide::Verdict verdict;
  };

  /// Makes the folders. Throws InputError where `out` already holds views: two boards in one set ruin both.
  CaptureSession(const Board& board, const Options& options);

  /// Finds the board, judges, and writes what is taken; `right` of a pair only, `at_once` as CaptureGuide::offer(). A
  /// ChArUco board's dictionary is found from the first images that show it. Throws RuntimeFailure where an image
  /// cannot be written, InputError where the size changes.
  Outcome show(const cv::Mat& left, const cv::Mat& right = {}, bool at_once = false);

  const CaptureGuide* guide() const { return guide_ ? &*guide_ : nullptr; }  ///< null before the first image
  CaptureProgress progress() const;                                          ///< also before it
  const Board& board() const { return board_; }
  bool stereo() const { return options_.stereo; }

 private:
  std::vector<std::filesystem::path> folders() const;

  Board board_;
  Options options_;
  std::optional<BoardFinder> finder_;
  std::optional<CaptureGuide> guide_;
  std::array<cv::Size, 2> sizes_;
};

}  // namespace foresight
