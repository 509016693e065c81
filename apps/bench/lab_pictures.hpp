// A short run of the built-in lab in memory: what a stereo head that looks about sees of the moving arm.
#pragma once

#include <functional>
#include <vector>

#include "link/coding/coded_pair.hpp"

namespace foresight {

struct LabPictureOptions {
  cv::Size size;
  std::size_t count = 0;
  double first_s = 0;  ///< in the lab's time, when the first one is taken
  bool right = true;   ///< the right camera's, too; else those are empty
};

/// Pairs of a camera of 30 pairs per second, rendered by sim/ as `foresight synth --stereo` does, with the
/// noise of a usual sensor (standard deviation 2 at mid grey). They play forth and back: at(t) at k periods is picture
/// k, then from the last one back to the first, and so on, so that every change is one that a camera sees.
class LabPictures {
 public:
  LabPictures(const LabPictureOptions& options, const std::function<void(std::size_t, std::size_t)>& progress);

  /// The pair that the camera took last at `time`, which is not negative.
  StereoPicture at(RobotTime time) const;
  static constexpr double kPairsPerSecond = 30;

 private:
  std::vector<StereoPicture> pairs_;
};

}  // namespace foresight
