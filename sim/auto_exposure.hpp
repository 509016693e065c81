// The exposure control of a webcam: it meters each image and follows with lag, in steps, within limits.
#pragma once

#include <functional>
#include <vector>

namespace foresight::sim {

/// What such controls have in common; the numbers are those of a usual USB camera. The control sees
/// nothing but its own images, so it is late by nature, and it is not in a hurry.
///
///     stop of exposure
///      ^          ______        each step: at most `largest_step`, every `interval` images,
///      |      ___|              only while the mean is off by more than `tolerance`,
///      |  ___|                  and in force `latency` images after the one that was metered
///      |_|______________> images
struct AutoExposure {
  double target = 0.42;        ///< mean of the 8-bit values / 255 that it aims at
  double tolerance = 0.25;     ///< stops (factors of two) of light that it leaves alone
  double largest_step = 0.34;  ///< stops
  double share = 0.5;          ///< of what is missing, taken back in one step
  int interval = 3;            ///< images from one step to the next, >= 1
  int latency = 2;             ///< images until a step is in force, >= 0
  double most_stops = 2;       ///< away from the exposure that the lab was lit for, both ways
};

/// Mean of the 8-bit values / 255, 0 .. 1, of image `image` at a factor on the light.
using Meter = std::function<double(int image, double factor)>;

/// Factor on the light of each of `images` images. It starts where the control would have come to
/// rest on the first one. Each depends on the images before only. One thread.
std::vector<double> run_auto_exposure(const AutoExposure& control, int images, const Meter& meter);

}  // namespace foresight::sim
