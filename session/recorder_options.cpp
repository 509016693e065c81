#include "session/recorder_options.hpp"

#include "common/error.hpp"

namespace foresight {

RecorderOptions recorder_options(const LiveScene& scene) {
  if (!scene.lenses())
    throw InputError("the cameras", "have no calibration",
                     "give it as `lens` in the rig, or with --camera and --camera-right");
  return {*scene.lenses(), scene.model()};
}

}  // namespace foresight
