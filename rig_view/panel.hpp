// The column beside a rig's picture: its joints as sliders, what colours mean, and what the gate sees.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "rig_view/rig_drawing.hpp"

namespace foresight {

inline constexpr int kPanelWidth = 330;  ///< px

struct PanelState {
  std::string title;
  std::vector<double> positions;  ///< of the rig's joints
  Layers layers = kAllLayers;
  int selected = -1;              ///< joint; -1: none
  std::string live;               ///< state of the running robot; "": none runs
  bool live_is_bad = false;       ///< it is one of trouble
  std::vector<std::string> help;  ///< lines at the foot
  std::string about_cameras;
};

/// Where things lie in a panel of this height. Pure geometry.
class PanelLayout {
 public:
  PanelLayout(std::size_t joints, int height);
  /// Of a joint: its name, value and slider; rows shrink where there are many.
  cv::Rect row(std::size_t joint) const;
  cv::Rect slider(std::size_t joint) const;
  cv::Rect legend(std::size_t layer) const;
  cv::Rect rest() const;  ///< what is left below

  /// What a click at a place is on.
  std::optional<std::size_t> joint_at(cv::Point p) const;
  std::optional<std::size_t> layer_at(cv::Point p) const;
  /// Position of the joint for a slider that is pulled to a column.
  double position_at(const DriveConfig& drive, std::size_t joint, int column) const;

 private:
  std::size_t joints_;
  int row_height_, top_ = 64;
};

/// Draws into `picture` (CV_8UC3, kPanelWidth columns).
void draw_panel(cv::Mat picture, const Rig& rig, const PanelState& state, const PlacedRig& placed);

}  // namespace foresight
