// Frames in time: FramePacing with a clock, and the extraction let in between them.
#pragma once

#include <memory>

#include "common/clock.hpp"
#include "display/frame_pacing.hpp"
#include "texture_gpu/frame_gate.hpp"

namespace foresight {

/// For each frame: wait(), look and draw, drawn(), swap, swapped(). The display's thread, its context current.
class FramePacer {
 public:
  /// `clock` must outlive this. `gate`: what the texture thread asks (ViewSetup::gate); null: nobody asks.
  FramePacer(Clock& clock, const FramePacingOptions& options, std::shared_ptr<FrameGate> gate = nullptr);

  /// Until the frame is to begin, or so long at most: true where it is. Who asks looks at its input in between.
  bool wait(Duration most);
  void drawn();  ///< all of it is ordered: waits for the GPU, so that the swap alone is left
  void swapped();
  void held_up();  ///< since the last swap, by what is no frame

  PacingFigures figures() const { return pacing_.figures(); }

 private:
  Clock& clock_;
  FramePacing pacing_;
  std::shared_ptr<FrameGate> gate_;
};

}  // namespace foresight
