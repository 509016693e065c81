// Frames in time: FramePacing with a clock.
#pragma once

#include "common/clock.hpp"
#include "display/frame_pacing.hpp"

namespace foresight {

/// For each frame: wait(), look and draw, drawn(), swap, swapped(). The display's thread, its context current.
class FramePacer {
 public:
  /// `clock` must outlive this.
  FramePacer(Clock& clock, const FramePacingOptions& options);

  /// Until the frame is to begin, or so long at most: true where it is. Who asks looks at its input in between.
  bool wait(Duration most);
  void drawn();  ///< all of it is ordered: waits for the GPU, so that the swap alone is left
  void swapped();

  PacingFigures figures() const { return pacing_.figures(); }

 private:
  Clock& clock_;
  FramePacing pacing_;
};

}  // namespace foresight
