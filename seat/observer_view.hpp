// The scene as it is seen from beside the operator: what his view sees is lit as by a lamp at his eye, and the newest
// images stand as panels before the cameras that took them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "display/frame_source.hpp"
#include "display/observer_pass.hpp"
#include "display/uploaded_picture.hpp"
#include "display/view_modes.hpp"
#include "display/view_session.hpp"
#include "gl/glfw_window.hpp"
#include "rig_view/eye.hpp"

namespace foresight {

/// Belongs to the session's context, but for the mouse, which needs none.
class ObserverView {
 public:
  /// Lenses of the cameras; `right`: nothing: as the left one.
  ObserverView(const Lens& left, const std::optional<Lens>& right);

  /// A frame has come: its poses and images, for the panels.
  void arrived(const PosedFrame& frame) { frame_ = frame; }
  /// Looks around, in a picture so many px high.
  void take_mouse(const gl::WindowInput& input, int height);

  /// As who looks on stands now, at first beside and above the operator. False: there are no textures yet.
  bool draw(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, ViewPaint paint);
  /// Of the last draw() that was true.
  const PredictedView& view() const { return *view_; }

  /// Nothing: nobody has looked yet.
  const std::optional<Eye>& eye() const { return eye_; }
  void stand(const std::optional<Eye>& eye) { eye_ = eye; }

 private:
  std::vector<CameraPanel> panels();

  Lens left_, right_;
  std::optional<PosedFrame> frame_;
  RobotTime uploaded_{};
  std::array<UploadedPicture, 2> pictures_;
  std::optional<Eye> eye_;
  std::optional<PredictedView> view_;
  std::optional<ObserverPass> pass_;
};

}  // namespace foresight
