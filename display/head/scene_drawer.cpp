#include "display/head/scene_drawer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight::head {
namespace {

constexpr Duration kSlowest = std::chrono::milliseconds(180), kNextTry = std::chrono::milliseconds(5);

/// As many px a radian, in the middle, as the eye has.
Lens wide_lens(const EyeAim& eye) {
  const EyeFov wide = widened(eye.fov, SceneDrawer::kGuard);
  const Lens::Parameters of_eye = (eye.panel ? *eye.panel : eye_lens(eye.fov, eye.width, eye.height)).parameters();
  const auto pixels = [](double focal, double from, double to) {
    return static_cast<int>(std::lround(focal * (std::tan(to) - std::tan(from))));
  };
  return eye_lens(wide, pixels(of_eye.fx, wide.left, wide.right), pixels(of_eye.fy, wide.down, wide.up));
}

/// Layers of that lens: those that are there, or new ones.
WarpLayers& fitting(std::optional<WarpLayers>& layers, const Lens& lens, bool of_part) {
  if (!layers || !alike(layers->lens, lens)) layers.emplace(lens, of_part);
  return *layers;
}

}  // namespace

bool same_sight(const EyeAim& a, const EyeAim& b) {
  return a.width == b.width && a.height == b.height && a.panel == b.panel && alike(a.fov, b.fov, 0);
}

SceneDrawer::SceneDrawer(const ViewSession& session, Clock& clock, const DrawerOptions& options)
    : session_(session),
      clock_(clock),
      options_(options),
      gate_(clock),
      parts_(std::make_shared<const WarpScene>(session.scene())) {}

void SceneDrawer::frame_begins() {
  gate_.frame_begins(FramesOf::headset);
  if (options_.others) options_.others->frame_begins(FramesOf::headset);
}

void SceneDrawer::frame_ends(RobotTime next) {
  gate_.frame_ends(next, FramesOf::headset);
  if (options_.others) options_.others->frame_ends(next, FramesOf::headset);
}

void SceneDrawer::make_way() {
  gate_.make_way();
  if (options_.others) options_.others->make_way();
}

void SceneDrawer::aim(HeadAim aim) {
  const std::lock_guard lock(mutex_);
  aim_ = std::move(aim);
}

bool SceneDrawer::draw() {
  HeadAim aim;
  {
    const std::lock_guard lock(mutex_);
    if (!aim_) return false;
    aim = *std::exchange(aim_, std::nullopt);
  }
  const ImagesLease images = session_.images();  // before the textures
  const TextureLease textures = session_.textures();
  if (!textures || aim.state.T_world_node.empty()) return false;
  if (!capture_) capture_.emplace(parts_);
  auto& slot = slots_.begin();
  if (!slot) slot.emplace();
  const Drawing drawing{aim, textures, images};
  const std::size_t eyes = aim.second_eye ? 2 : 1;
  if (eyes == 1) slot->eyes[1].reset();
  const RobotTime begin = clock_.now();
  for (std::size_t eye = 0; eye < eyes; ++eye) draw_front(eye, drawing, *slot);
  const bool is_quick = clock_.now() - begin <= options_.behind_edges_within;
  for (std::size_t eye = 0; eye < 2; ++eye)
    if (is_quick && eye < eyes)
      draw_behind(eye, drawing, *slot);
    else
      slot->behind[eye].reset();
  slots_.end();
  glFinish();  // who draws and shows in one thread finds it at once
  ++drawn_;
  return true;
}

// A part of the work that frames do not wait for.
template <typename Work>
void SceneDrawer::slice(const char* kind, Work work) {
  if (options_.in_bands) gate_.begin(kind);
  work();
  glFinish();
  if (options_.in_bands) gate_.end();
}

void SceneDrawer::draw_front(std::size_t eye, const Drawing& drawing, DrawnEyes& into) {
  const Lens& lens = lenses_[eye](drawing.aim.eyes[eye], wide_lens);
  auto& view = views_[eye];
  if (!view || !alike(view->lens(), lens)) view.reset();
  if (!view) {
    view.emplace(session_.make_view(lens)).use(options_.in_bands ? &gate_ : nullptr);
    view->mix_silhouettes(false);  // they come apart when the view is warped
  }
  view->draw_part(std::nullopt);
  draw_layers(eye, drawing, fitting(into.eyes[eye], view->lens(), false));
}

void SceneDrawer::draw_behind(std::size_t eye, const Drawing& drawing, DrawnEyes& into) {
  PredictedView& view = *views_[eye];
  slice("edges of a view", [&] { view.draw_part(capture_->behind_edges(*into.eyes[eye])); });
  draw_layers(eye, drawing, fitting(into.behind[eye], view.lens(), true));
}

void SceneDrawer::draw_layers(std::size_t eye, const Drawing& drawing, WarpLayers& into) {
  PredictedView& view = *views_[eye];
  const Pose& from = drawing.aim.eyes[eye].T_world_eye;
  view.draw(from, drawing.aim.state, drawing.textures, drawing.images);
  slice("layers of a view", [&] { (*capture_)(view.picture(), view.faces(), from, drawing.aim.state, into); });
}

void SceneDrawer::release() {
  for (auto& view : views_) view.reset();
  capture_.reset();
}

SceneThread::SceneThread(std::unique_ptr<gl::Context> context, SceneDrawer& drawer, Clock& clock)
    : context_(std::move(context)), drawer_(drawer), clock_(clock), thread_([this] { run(); }) {}

SceneThread::~SceneThread() {
  stop_ = true;
  thread_.join();
}

void SceneThread::run() {
  try {
    context_->make_current();
    gl::set_up_context();
    while (!stop_) {
      const RobotTime begin = clock_.now();
      if (!drawer_.draw()) {
        clock_.sleep_until(begin + kNextTry);
        continue;
      }
      const Duration took = clock_.now() - begin;
      if (took < kSlowest) clock_.sleep_until(begin + std::min(2 * took, kSlowest));
    }
    drawer_.release();
    gl::check_errors("the views of a head display");
    context_->release();
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.what();
  }
}

std::string SceneThread::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

}  // namespace foresight::head
