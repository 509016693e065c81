// What the person who holds the board should see: large words, the missing part of the image, bars.
#pragma once

#include <filesystem>

#include "calibration/target/capture_session.hpp"

namespace foresight {

/// All that a picture is made from. Images are 8 bit, colours or grey; `right` is empty of a lone camera.
struct CaptureMoment {
  cv::Mat left, right;
  CaptureSession::Outcome outcome;  ///< of these images or, where the finder is slower, of earlier ones
  CaptureProgress progress;
};

inline constexpr int kCapturePictureWidth = 1280, kCapturePictureHeight = 800;

/// The left image with the parts that are missing, the outlines of the views taken and the points found; above it what
/// to do next and why this image was not taken, beside it bars, the right image and the map of uncertainty. CV_8UC3,
/// readable from 2 m on a usual screen.
cv::Mat capture_picture(const CaptureMoment& moment);

/// Writes a PNG, at once or not at all. Throws RuntimeFailure.
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace foresight
