#include "scene/posed_frame.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr double kMarginSigmas = 2;
constexpr double kLargestMargin = 8;

}  // namespace

double margin_for(double margin_px, double predicted_px) {
  return std::max(margin_px, std::min(margin_px + kMarginSigmas * predicted_px, kLargestMargin));
}

}  // namespace foresight
