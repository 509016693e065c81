#include "display/head/scene_drawer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight::head {
namespace {

constexpr double kWidestGuarded = 85 * EIGEN_PI / 180;  // rad
constexpr Duration kSlowest = std::chrono::milliseconds(180), kNextTry = std::chrono::milliseconds(5);

/// As many px a radian, in the middle, as `fov` has on `pixels`.
int pixels_of(double from, double to, double wide_from, double wide_to, int pixels) {
  return static_cast<int>(
      std::lround(pixels * (std::tan(wide_to) - std::tan(wide_from)) / (std::tan(to) - std::tan(from))));
}

Lens wide_lens(const EyeAim& eye, double guard) {
  const EyeFov &fov = eye.fov, wide = widened(fov, guard);
  return eye_lens(wide, pixels_of(fov.left, fov.right, wide.left, wide.right, eye.width),
                  pixels_of(fov.down, fov.up, wide.down, wide.up, eye.height));
}

}  // namespace

EyeFov widened(const EyeFov& fov, double guard) {
  return {std::max(fov.left - guard, std::min(fov.left, -kWidestGuarded)),
          std::min(fov.right + guard, std::max(fov.right, kWidestGuarded)),
          std::min(fov.up + guard, std::max(fov.up, kWidestGuarded)),
          std::max(fov.down - guard, std::min(fov.down, -kWidestGuarded))};
}

SceneDrawer::SceneDrawer(const ViewSession& session, Clock& clock)
    : session_(session), gate_(clock), parts_(std::make_shared<const WarpScene>(session.scene())) {}

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
  const TextureLease textures = session_.textures();
  if (!textures || aim.state.T_world_node.empty()) return false;
  const ImageLease image = session_.image();
  if (!capture_) capture_.emplace(parts_);
  auto& slot = slots_.begin();
  if (!slot) slot.emplace();
  for (std::size_t eye = 0; eye < 2; ++eye) {
    if (eye == 1 && !aim.second_eye) {
      slot->eyes[eye].reset();
      continue;
    }
    const Lens lens = wide_lens(aim.eyes[eye], kGuard);
    auto& view = views_[eye];
    if (!view || !alike(view->lens(), lens)) view.reset();
    if (!view) view.emplace(session_.make_view(lens)).use(&gate_);
    auto& layers = slot->eyes[eye];
    if (!layers || !alike(layers->lens, view->lens())) layers.emplace(view->lens());
    const Pose& from = aim.eyes[eye].T_world_eye;
    view->draw(from, aim.state, textures, image);
    gate_.begin("layers of a view");
    (*capture_)(view->picture(), view->faces(), from, aim.state, *layers);
    glFinish();
    gate_.end();
  }
  slots_.end();
  ++drawn_;
  return true;
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
