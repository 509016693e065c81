// Who draws what a head display shows.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "display/head/eye_geometry.hpp"
#include "display/view_target.hpp"

namespace foresight::head {

/// One frame: for the instant at which it will be seen.
struct HeadFrame {
  std::uint64_t number = 0;
  std::optional<Pose> T_space_head;  ///< nothing: nobody knows where the head is, and eyes are not drawn
  std::array<EyeView, 2> eyes;       ///< left and right
  bool space_moved = false;          ///< the runtime's origin is another one from this frame on
};

/// A picture that stands in the room or goes with the head: words, a camera's image.
struct Panel {
  bool shown = false;
  bool changed = false;                   ///< is to be drawn anew
  bool head_fixed = false;                ///< the pose is by the head, not by the room
  int width_px = 0, height_px = 0;        ///< 0: not shown
  double width = 1;                       ///< m; the height follows from the pixels
  Pose T_frame_panel = Pose::Identity();  ///< its middle; x away from who looks at it, y to its left, z up
};

/// Called in the head display's thread, its context current: for each frame look(), panels(), then what is to be drawn.
class HeadPainter {
 public:
  virtual ~HeadPainter() = default;
  /// Before the runtime is asked for a frame: time for what frames have held up.
  virtual void make_way() {}
  virtual void look(const HeadFrame& frame) = 0;
  /// At most 8, each over those before it; those beyond are not shown. Valid until the next look().
  virtual std::span<const Panel> panels() = 0;
  /// All of `target`. `view.fov` stays the same over many frames.
  virtual void draw_eye(std::size_t eye, const EyeView& view, const ViewTarget& target) = 0;
  /// All of `target`; premultiplied alpha counts.
  virtual void draw_panel(std::size_t panel, const ViewTarget& target) = 0;
};

}  // namespace foresight::head
