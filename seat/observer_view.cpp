#include "seat/observer_view.hpp"

#include <algorithm>
#include <cmath>

#include "seat/view_through.hpp"

namespace foresight {
namespace {

constexpr double kLooksAt = 0.8;    // m before the operator's camera, at first
constexpr double kBesideRad = 0.7;  // to his right
constexpr double kAboveRad = 0.5;
constexpr double kDistance = 1.9;    // m
constexpr double kMostPixels = 1.3;  // of the camera's: who looks on needs no more

Eye eye_beside(const Pose& T_world_operator) {
  const Eigen::Vector3d forward = T_world_operator.linear().col(2);
  Eye out;
  out.target = T_world_operator * Eigen::Vector3d(0, 0, kLooksAt);
  out.azimuth = std::atan2(-forward.y(), -forward.x()) + kBesideRad;
  out.elevation = kAboveRad;
  out.distance = kDistance;
  return out;
}

}  // namespace

ObserverView::ObserverView(const Lens& left, const std::optional<Lens>& right)
    : left_(left),
      right_(right.value_or(left)),
      pictures_{UploadedPicture("left panel"), UploadedPicture("right panel")} {}

void ObserverView::take_mouse(const gl::WindowInput& input, int height) {
  if (!eye_) return;
  if (input.left) eye_->orbit(input.moved_x, input.moved_y);
  if (input.other) eye_->shift(input.moved_x, input.moved_y, std::max(1, height));
  if (input.scrolled != 0) eye_->zoom(input.scrolled);
}

std::vector<CameraPanel> ObserverView::panels() {
  std::vector<CameraPanel> out;
  if (!frame_) return out;
  if (pictures_[0].empty() || frame_->left.time != uploaded_) {
    pictures_[0].upload(frame_->left.pixels);
    if (frame_->right) pictures_[1].upload(frame_->right->pixels);
    uploaded_ = frame_->left.time;
  }
  out.push_back({left_, frame_->left.T_world_camera, &pictures_[0].texture()});
  if (frame_->right) out.push_back({right_, frame_->right->T_world_camera, &pictures_[1].texture()});
  return out;
}

bool ObserverView::draw(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, ViewPaint paint) {
  if (!eye_) eye_ = eye_beside(place.T_world_camera);
  const double pixels = static_cast<double>(whole.width) * whole.height,
               most = kMostPixels * left_.width() * left_.height();
  const double scale = std::min(1.0, std::sqrt(most / std::max(1.0, pixels)));
  const int width = std::max(1, static_cast<int>(scale * whole.width)),
            height = std::max(1, static_cast<int>(scale * whole.height));
  const Lens lens = observer_lens(width, height, eye_->distance / (eye_->metres_per_pixel(height) * height));
  PredictedView& view = view_through(view_, session, lens);
  view.set_paint(paint);
  if (!session.draw(view, eye_->T_world_eye(), place.scene)) return false;
  if (!pass_) pass_.emplace();
  const std::vector<CameraPanel> all = panels();
  (*pass_)(view, eye_->T_world_eye(), session.view(), place.T_world_camera, all);
  return true;
}

}  // namespace foresight
