// Corners to a fraction of a pixel, with the noise of each.
#pragma once

#include <opencv2/core.hpp>

namespace foresight {

/// Half window of cornerSubPix for a corner whose nearest neighbour lies `spacing` px away: a
/// quarter of it, 2 to 11 px. It halves the error of the customary 11 on real images.
int refinement_half_window(float spacing, double share = 0.25);

/// A saddle where two edges cross, from an estimate a few pixels off.
cv::Point2f refine_corner(const cv::Mat& grey, cv::Point2f start, int half_window);

/// Standard deviation of a coordinate of a corner where straight edges meet, px, from what the
/// image itself shows around it. cornerSubPix solves A q = sum w g g' p (g: gradient at p); the
/// pixels' disagreement e = g'(p - q) gives the covariance A^-1 (sum w^2 e^2 g g') A^-1 (White's
/// sandwich): blur, noise, curved edges and clutter all raise it. At least 0.03.
double corner_noise(const cv::Mat& grey, cv::Point2f corner, int half_window);

/// The same for the centre of a dark or bright disc of `radius` px: pixel noise over the slope of
/// its rim, shared by the pixels along it. At least 0.03.
double disc_noise(const cv::Mat& grey, cv::Point2f centre, double radius, double pixel_noise);

/// Noise of an image's pixels, grey values: the median second difference (Immerkaer 1996), which
/// edges do not move.
double pixel_noise(const cv::Mat& grey);

}  // namespace foresight
