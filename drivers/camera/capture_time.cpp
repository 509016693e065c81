#include "drivers/camera/capture_time.hpp"

#include <algorithm>
#include <chrono>

namespace foresight {
namespace {

constexpr Duration kStampUncertainty = std::chrono::milliseconds(1);  // of the interrupt that stamps, and of transfers

}  // namespace

ToMiddle to_middle_of_exposure(std::optional<Duration> exposure, const CameraSettings& settings) {
  const Duration period = seconds(1 / settings.rate);
  const bool knows_readout = settings.readout.count() >= 0;
  const Duration readout = knows_readout ? settings.readout : period / 2;
  ToMiddle out{(std::min(exposure.value_or(period / 2), period) + readout) / 2, kStampUncertainty};
  if (!exposure) out.uncertainty += period / 4;
  if (!knows_readout) out.uncertainty += period / 4;
  return out;
}

}  // namespace foresight
