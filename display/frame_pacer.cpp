#include "display/frame_pacer.hpp"

#include <algorithm>

#include "gl/objects.hpp"

namespace foresight {

FramePacer::FramePacer(Clock& clock, const FramePacingOptions& options)
    : clock_(clock), pacing_(options, clock.now()) {}

bool FramePacer::wait(Duration most) {
  clock_.sleep_until(std::min(pacing_.wake(), clock_.now() + most));
  return clock_.now() >= pacing_.wake();
}

void FramePacer::drawn() {
  glFinish();
  pacing_.drawn(clock_.now());
}

// The extraction always has images to come: it gets its rest.
void FramePacer::swapped() {
  pacing_.swapped(clock_.now(), true);
}

}  // namespace foresight
