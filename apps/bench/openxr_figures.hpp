// A session with the OpenXR runtime of this machine.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/bench/head_lab.hpp"

namespace foresight {

/// Shows so many frames of the lab in the headset of the active runtime (XR_RUNTIME_JSON), or as many as come in three
/// times as long as they should take: from the start of the session to the first frame with eyes in it (bar: 2 s), and
/// to the first that shows the scene; frames, those without a pose, time that jumped, sessions lost. What the runtime
/// itself and its validation layer say is theirs (docs/head-display.md). Prints them; `trouble` says why nothing was
/// shown. Null where no frames are wanted.
nlohmann::json openxr_figures(HeadLab& lab, gl::Context& context, int frames);

}  // namespace foresight
