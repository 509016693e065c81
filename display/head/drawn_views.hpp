// What the frames of a head display are warped from, and where it is told what they show: of a thread of this process,
// or of another process.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "display/head/eye_geometry.hpp"
#include "display/warp/warp_layers.hpp"

namespace foresight::head {

/// What an eye is shown.
struct EyeAim {
  Pose T_world_eye = Pose::Identity();  ///< of its camera (optical frame)
  EyeFov fov;
  int width = 0, height = 0;  ///< px
  /// What the eye looks at its panel through, of that size, where nobody else does away with its distortion; null: the
  /// pinhole that shows `fov`.
  std::shared_ptr<const Lens> panel = nullptr;
};

/// What is seen of such an eye: all but the pose.
bool same_sight(const EyeAim& a, const EyeAim& b);

/// Where eyes and scene are, as the display knows them.
struct HeadAim {
  std::array<EyeAim, 2> eyes;  ///< left and right
  SceneState state;
  bool second_eye = true;  ///< false: the right one's frames are made of the left one's
};

/// A view drawn for each eye.
struct DrawnEyes {
  std::array<std::optional<WarpLayers>, 2> eyes;  ///< the second is empty where nobody asked for it
  std::array<std::optional<WarpLayers>, 2>
      behind;  ///< of each, what it hides near edges; empty where that is not drawn
};

/// The showing thread's side of who draws.
class DrawnViews {
 public:
  virtual ~DrawnViews() = default;

  virtual const std::shared_ptr<const WarpScene>& parts() const = 0;

  /// Drawing goes on between frames; the next one is due at `next`.
  virtual void frame_begins() = 0;
  virtual void frame_ends(RobotTime next) = 0;
  /// Before a frame is asked for: work that frames have put off for long enough goes first (FrameGate::make_way).
  virtual void make_way() = 0;

  /// What is drawn next; the newest counts.
  virtual void aim(HeadAim aim) = 0;
  /// The newest views that the GPU has finished, until the next call; null before the first.
  virtual const DrawnEyes* newest() = 0;
  /// All commands that read newest() are given.
  virtual void shown() = 0;
};

}  // namespace foresight::head
