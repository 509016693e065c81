#include "display/head/scene_painter.hpp"

namespace foresight::head {
namespace {

constexpr double kWordsWidth = 0.9, kWordsAway = 1.2, kWordsDown = 0.55;  // m: below what is worked at
constexpr double kImageWidth = 0.6, kImageAway = 1.5, kImageRight = 0.75, kImageUp = 0.3;
constexpr double kLargeImage = 1.6;

/// Faces who is at the origin.
Pose facing(const Eigen::Vector3d& at) {
  Pose out = Pose::Identity();
  out.translation() = at;
  const double left = std::atan2(at.y(), at.x()), down = std::atan2(-at.z(), at.head<2>().norm());
  out.linear() = (Eigen::AngleAxisd(left, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(down, Eigen::Vector3d::UnitY()))
                     .toRotationMatrix();
  return out;
}

}  // namespace

ScenePainter::ScenePainter(SceneDrawer& drawer, const HeldControllers& hands, Clock& clock, SharedPicture* words,
                           SharedPicture* image, SecondEyeFrom second)
    : drawer_(drawer), hands_(hands), clock_(clock), second_(second), pictures_{image, words} {}

void ScenePainter::show(HeadScene scene) {
  const std::lock_guard lock(mutex_);
  scene_ = std::move(scene);
  any_scene_ = true;
}

std::optional<Pose> ScenePainter::T_world_space() const {
  const std::lock_guard lock(mutex_);
  return T_world_space_;
}

bool ScenePainter::centre_pressed() {
  bool held = false;
  for (const HeldController& hand : hands_.hands) {
    const TrackerState state = hand.heard();
    held |= state.connected &&
            (state.buttons.held(TrackerButton::recentre) || state.buttons.held(TrackerButton::home_view));
  }
  const bool pressed = held && !pressed_;
  pressed_ = held;
  return pressed;
}

void ScenePainter::make_way() {
  if (warper_) warper_->make_way();
}

void ScenePainter::look(const HeadFrame& frame) {
  if (!copy_) copy_.emplace();
  if (centre_pressed() || frame.space_moved) centre_ = true;
  place_space(frame);
  place_panels();
  if (!warper_) warper_.emplace(drawer_, clock_, second_);
  shows_scene_ = frame.T_space_head && T_world_space_ && shown_.trusted && !shown_.place.scene.T_world_node.empty();
  if (shows_scene_) warper_->begin(shown_.place.scene);
}

void ScenePainter::place_space(const HeadFrame& frame) {
  const std::lock_guard lock(mutex_);
  if (!any_scene_) return;
  shown_ = scene_;
  if (!frame.T_space_head || !shown_.trusted || (T_world_space_ && !centre_.exchange(false))) return;
  T_world_space_ = T_world_space_for(shown_.place.T_world_camera, *frame.T_space_head);
  T_space_centre_ = levelled(*frame.T_space_head);
}

void ScenePainter::place_panels() {
  const auto put = [this](std::size_t i, double width, const Pose& pose) {
    Panel& panel = panels_[i];
    SharedPicture* const picture = pictures_[i];
    panel.shown = picture != nullptr;
    if (!picture) return;
    panel.changed = picture->fresh();
    panel.width_px = picture->width();
    panel.height_px = picture->height();
    panel.width = width;
    panel.T_frame_panel = pose;
  };
  if (shown_.trusted)
    put(0, kImageWidth, T_space_centre_ * facing({kImageAway, -kImageRight, kImageUp}));
  else
    put(0, kLargeImage, T_space_centre_ * facing({kImageAway, 0, 0}));
  put(1, kWordsWidth, facing({kWordsAway, 0, -kWordsDown}));
  panels_[1].head_fixed = true;
}

void ScenePainter::draw_eye(std::size_t eye, const EyeView& view, const ViewTarget& target) {
  if (!shown_.trusted)
    fill(target, 0.25f, 0.03f, 0.03f);  // what is shown is old, and the words say why
  else if (!draw_scene(eye, view, target))
    fill(target, 0.12f, 0.13f, 0.15f);
}

bool ScenePainter::draw_scene(std::size_t eye, const EyeView& view, const ViewTarget& target) {
  if (!shows_scene_) return false;
  const Pose T_world_eye = *T_world_space_ * view.T_space_eye * T_body_camera();
  const gl::Texture* const picture = (*warper_)(eye, {T_world_eye, view.fov, target.width, target.height});
  if (picture) (*copy_)(*picture, target, target.width);
  if (eye == 1) warper_->end();
  return picture;
}

void ScenePainter::draw_panel(std::size_t panel, const ViewTarget& target) {
  if (pictures_[panel]->show(*copy_, target)) return;
  constexpr float kNothing[4] = {0, 0, 0, 0};
  glClearNamedFramebufferfv(target.framebuffer, GL_COLOR, 0, kNothing);
}

void ScenePainter::release() {
  warper_.reset();
  copy_.reset();
}

}  // namespace foresight::head
