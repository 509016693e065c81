// Feeds a capture session from its source, and shows the person with the board how it goes.
#pragma once

#include <filesystem>

#include "apps/calibrate/capture_source.hpp"
#include "calibration/target/capture_session.hpp"
#include "common/clock.hpp"

namespace foresight {

struct CaptureLoopOptions {
  std::filesystem::path pictures;  ///< gets now.png, for eyes elsewhere; empty: none
  Duration longest{0};
  Duration silent_after = std::chrono::seconds(5);  ///< without an image, a camera counts as gone
};

enum class CaptureEnd { enough, closed, interrupted, late, silent, no_more_images };
const char* to_string(CaptureEnd end);

/// Finds and judges in this thread. Until it is enough, SIGINT or SIGTERM, or the source has no more. Throws
/// RuntimeFailure where no image came at all, and what CaptureSession::show() throws.
CaptureEnd capture_with_pictures(CaptureSource& source, CaptureSession& session, const Clock& clock,
                                 const CaptureLoopOptions& options);

/// The same with a window, which stays alive while a second thread finds and judges: Escape, Q or closing it ends,
/// Space takes what the camera sees now. Main thread only. Throws also where there is no desktop, before it touches
/// the source.
CaptureEnd capture_with_window(CaptureSource& source, CaptureSession& session, const Clock& clock,
                               const CaptureLoopOptions& options);

/// A desktop is there, as far as the environment tells.
bool has_display();

}  // namespace foresight
