// Behavioural levels: what moves with little effect on the view is moved more rarely.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/lod/acuity.hpp"
#include "scene/visibility.hpp"

namespace foresight {

struct MotionLevelOptions {
  double px = 0.5;              ///< that a node may be seen beside where it is, straight ahead
  bool eye_looks_ahead = true;  ///< beside that, more; false: nowhere more
  AcuityOptions acuity{};
};

/// Where an eye is, and how sharp its view.
struct MotionView {
  Pose T_world_camera = Pose::Identity();
  double focal_px = 500;
};

/// Holds each node where it was shown last, as long as nobody can tell: no corner of its box is farther from there than
/// what is seen as `px`, or as 1 / acuity times that beside the middle of the view. One thread.
class MotionLevels {
 public:
  explicit MotionLevels(const NodeBoxes& boxes, const MotionLevelOptions& options = {});

  /// `state` with the nodes that are held where they are held. A state of another count of nodes, and views that are no
  /// numbers, are handed back as they are.
  SceneState shown(const SceneState& state, const MotionView& view);

  struct Counts {
    std::uint64_t moved = 0;  ///< nodes that stood elsewhere than in the state before, summed over states
    std::uint64_t shown = 0;  ///< of them, those that were moved in the picture as well
  };
  const Counts& counts() const { return counts_; }

 private:
  bool can_be_held(std::size_t node, const Pose& T_world_node, const MotionView& view) const;

  MotionLevelOptions options_;
  NodeBoxes boxes_;
  std::vector<Pose> held_, newest_;
  Counts counts_;
};

}  // namespace foresight
