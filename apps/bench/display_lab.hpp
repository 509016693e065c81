// What `foresight bench display` looks at: the lab as the seat shows it, half a second after the newest image.
#pragma once

#include <opencv2/core.hpp>

#include "apps/bench/display_trial.hpp"
#include "display/frame_source.hpp"

namespace foresight {

/// A view, and the images that have come when it is drawn.
struct DisplayView {
  const char* name;
  ViewPlace place;
  std::vector<PosedFrame> images;  ///< of the left camera, as it looked about until the delay before the view
  std::size_t polygons = 0;        ///< of which it shows something
};

struct DisplayLab {
  DisplayScene scene;
  int polygons = 0;
  DisplayView few, many;  ///< along the head's way, where it sees fewest and most polygons
};

/// An OpenGL context is current, and is set up here. `image_size`: of what the camera takes, `view_size`: of what is
/// drawn.
DisplayLab make_display_lab(cv::Size image_size, cv::Size view_size);

/// The lab's left camera, which the view is drawn through, too, as at the seat.
Lens display_lens(cv::Size size);

}  // namespace foresight
