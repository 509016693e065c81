// Two eyes beside each other where the view's camera is, for a display that shows them side by side.
#pragma once

#include <array>

#include "display/view_session.hpp"

namespace foresight {

/// Belongs to the session's context and thread.
class EyePair {
 public:
  /// Eyes `separation` m apart, each through its lens, left and right. Lenses of a head display's panels may be
  /// distorted: the pictures are then such that its optics show them straight. The session, not with `thesis`, must
  /// outlive this.
  EyePair(ViewSession& session, const std::array<Lens, 2>& lenses, double separation);

  /// PredictedView::set_lens, of both.
  void set_lenses(const std::array<Lens, 2>& lenses);
  const Lens& lens(std::size_t eye) const { return eyes_[eye].lens(); }

  /// As ViewSession::draw, the eyes to the left and right of the camera.
  bool draw(const Pose& T_world_camera, const SceneState& state);
  /// PredictedView::show_vignetting, of both.
  void show_vignetting(bool shown) {
    for (PredictedView& eye : eyes_) eye.show_vignetting(shown);
  }
  /// PredictedView::set_paint, of both.
  void set_paint(ViewPaint paint) {
    for (PredictedView& eye : eyes_) eye.set_paint(paint);
  }
  /// 0: left.
  const gl::Texture& picture(std::size_t eye) const { return eyes_[eye].picture(); }
  const gl::FaceImages& faces(std::size_t eye) const { return eyes_[eye].faces(); }
  Pose T_view_eye(std::size_t eye) const {
    return Pose(Eigen::Translation3d((eye == 0 ? -0.5 : 0.5) * separation_, 0, 0));
  }

 private:
  ViewSession& session_;
  double separation_;
  std::vector<PredictedView> eyes_;
};

}  // namespace foresight
