// Figures of samples. All take values in any order; of none, each is 0.
#pragma once

#include <span>
#include <vector>

namespace foresight {

/// The value that `share` (0 to 1) of the others lie below; between two values, linearly.
double quantile(std::vector<double> values, double share);
float quantile(std::vector<float> values, double share);

/// The middle value, of an even number the mean of the middle two.
double median(std::vector<double> values);
float median(std::vector<float> values);

/// 1.4826 times the median absolute value: the standard deviation of normal values about zero, of which up to half may
/// be wrong.
double robust_sigma(std::vector<double> values);

/// Standard deviation of each of two coordinates, by the lengths of normal errors in the plane: their median over that
/// of Rayleigh's distribution.
double robust_sigma_of_lengths(std::vector<double> lengths);

double root_mean_square(std::span<const double> values);

}  // namespace foresight
