// A whole picture of a rig: the scene in three dimensions, its words, and the panel beside it.
#pragma once

#include <opencv2/core.hpp>

#include "rig_view/draw_pass.hpp"
#include "rig_view/panel.hpp"

namespace foresight {

/// For set-up and documents, not for driving by: it is put together on the CPU. Belongs to one context.
class RigPicture {
 public:
  explicit RigPicture(const RigBody& body);

  /// CV_8UC3, BGR. `width` > kPanelWidth. `placed`: RigBody::at(state.positions).
  cv::Mat operator()(const RigBody& body, const PlacedRig& placed, const PanelState& state, const Eye& eye, int width,
                     int height);

 private:
  DrawPass pass_;
  std::vector<bool> is_link_;  // of each node; else it stands around
};

}  // namespace foresight
