// When a rolling shutter's image was taken.
#pragma once

#include <optional>

#include "drivers/camera/camera.hpp"

namespace foresight {

/// From the start of the first row's exposure to the middle of the middle row's; as long again is it to the last row's
/// end.
struct ToMiddle {
  Duration span{0};
  Duration uncertainty{0};  ///< half width
};

/// `exposure`: nothing where it is unknown. What is not known is taken as half a frame period, the most that it can be
/// being a whole one.
ToMiddle to_middle_of_exposure(std::optional<Duration> exposure, const CameraSettings& settings);

}  // namespace foresight
