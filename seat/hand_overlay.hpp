// What is drawn of the operator's hand over the view: its ghost, what touches, what is on its way, what is near its
// end.
//
//   known place of the tool  o- - o - - o - - > shown tool ........ ghost of the gripper: where the hand is
//                              committed path       |  12 mm
//                                                 table
//
// Nothing is told by colour alone: the ghost is dashed, the committed path dotted with rings at its begin, contacts are
// circles, limits are dials; words stand beside all of them.
#pragma once

#include <string>
#include <vector>

#include "display/overlay_lines.hpp"
#include "prediction/robot_future.hpp"
#include "seat/hand_sight.hpp"

namespace foresight {

/// Words at a place of the world.
struct WorldLabel {
  Eigen::Vector3d at;
  std::string words;
  Urgency urgency = Urgency::fine;
};

struct HandPicture {
  OverlayLines lines;
  std::vector<WorldLabel> labels;  ///< what matters most first
};

/// One thread.
class HandOverlay {
 public:
  /// `hand`: of this rig, with or without an arm; a rig without draws nothing. `rig` must outlive this.
  HandOverlay(const Rig& rig, const HandOptions& hand);

  /// `under_way`: Seat::under_way(); its last is the robot as it is shown.
  HandPicture draw(const HandSight& sight, const std::vector<PredictedRobot>& under_way);

 private:
  struct Part {
    std::size_t link;
    WireMesh wire;
  };
  Pose T_world_tool(const JointValues& joints) const;
  void draw_path(const std::vector<PredictedRobot>& under_way, HandPicture& out) const;
  void draw_ghost(const HandSight& sight, HandPicture& out) const;
  void draw_near(const HandSight& sight, HandPicture& out) const;
  void draw_limits(const JointValues& shown, HandPicture& out) const;

  const Rig& rig_;
  const HandOptions hand_;
  std::vector<std::string> names_;
  std::optional<PosedLinks> links_;
  std::size_t tool_ = 0;           // link
  std::vector<Part> gripper_;      // links that the tool is, or carries
  std::vector<Pose> T_tool_part_;  // as of the newest draw()
};

}  // namespace foresight
