// Robust figures of samples.
#pragma once

#include <vector>

namespace foresight {

/// The middle value, of an even number the mean of the middle two; 0 of none.
double median(std::vector<double> values);

}  // namespace foresight
