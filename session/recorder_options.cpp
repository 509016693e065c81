#include "session/recorder_options.hpp"

#include "common/error.hpp"

namespace foresight {

RecorderOptions recorder_options(const LiveScene& scene) {
  if (!scene.lenses())
    throw InputError("the cameras", "have no calibration",
                     "give it as `lens` in the rig, or with --camera and --camera-right");
  RecorderOptions out{*scene.lenses(), scene.model()};
  if (scene.model())
    for (std::size_t i = 0; i < scene.model()->nodes().size(); ++i) out.moves.push_back(scene.moves(i));
  return out;
}

}  // namespace foresight
