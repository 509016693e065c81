#include "display/head/xr_session.hpp"

#include <cmath>

#include "display/head/xr_poses.hpp"

namespace foresight::head {
namespace {

constexpr XrViewConfigurationType kStereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
constexpr XrTime kJump = 1'000'000'000;  // ns ahead of the frame before
constexpr double kSameFov = 0.01;        // rad: a new lens is made for more
constexpr std::size_t kMostMoves = 16;
constexpr XrSpaceLocationFlags kPlace = XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
constexpr XrViewStateFlags kViews = XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT;

constexpr XrPosef kIdentity{{0, 0, 0, 1}, {0, 0, 0}};

XrSpace make_space(XrSession session, XrReferenceSpaceType type) {
  XrReferenceSpaceCreateInfo info{};
  info.type = XR_TYPE_REFERENCE_SPACE_CREATE_INFO;
  info.referenceSpaceType = type;
  info.poseInReferenceSpace = kIdentity;
  XrSpace out = XR_NULL_HANDLE;
  check(xrCreateReferenceSpace(session, &info, &out), "xrCreateReferenceSpace");
  return out;
}

int scaled(std::uint32_t recommended, std::uint32_t most, const SessionOptions& options) {
  const double wanted = std::round(recommended * options.scale);
  const double limit = std::min<double>(most, options.most_px);
  return static_cast<int>(std::min(wanted, limit));
}

}  // namespace

Session::Session(const Instance& instance, XrSystemId headset, const GraphicsBinding& graphics,
                 const SessionOptions& options) {
  instance.check_graphics(headset);
  XrSystemProperties system{};
  system.type = XR_TYPE_SYSTEM_PROPERTIES;
  check(xrGetSystemProperties(instance.get(), headset, &system), "xrGetSystemProperties");
  name_ = std::string(system.systemName, ::strnlen(system.systemName, XR_MAX_SYSTEM_NAME_SIZE));
  const auto blends = listed<XrEnvironmentBlendMode>(
      "xrEnumerateEnvironmentBlendModes", XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
      [&](std::uint32_t room, std::uint32_t* count, XrEnvironmentBlendMode* out) {
        return xrEnumerateEnvironmentBlendModes(instance.get(), headset, kStereo, room, count, out);
      });
  // In the order of the runtime's own preference, where a room behind the glasses is seen in any case.
  const bool opaque = std::ranges::find(blends, XR_ENVIRONMENT_BLEND_MODE_OPAQUE) != blends.end();
  if (!opaque && !blends.empty()) blend_ = blends.front();
  XrSessionCreateInfo info{};
  info.type = XR_TYPE_SESSION_CREATE_INFO;
  info.next = graphics.chain.get();
  info.systemId = headset;
  check(xrCreateSession(instance.get(), &info, &session_), "xrCreateSession");
  try {
    make_spaces(options.stage);
    format_ = picture_format(session_);
    make_eyes(instance, headset, options);
    controllers_.emplace(instance.get(), session_);
  } catch (...) {
    for (auto& eye : eyes_) eye.reset();
    xrDestroySession(session_);
    throw;
  }
}

Session::~Session() {
  controllers_.reset();
  for (auto& panel : panels_) panel.reset();
  for (auto& eye : eyes_) eye.reset();
  xrDestroySession(session_);
}

void Session::make_spaces(bool stage) {
  if (stage) {
    const auto types =
        listed<XrReferenceSpaceType>("xrEnumerateReferenceSpaces", XR_REFERENCE_SPACE_TYPE_LOCAL,
                                     [this](std::uint32_t room, std::uint32_t* count, XrReferenceSpaceType* out) {
                                       return xrEnumerateReferenceSpaces(session_, room, count, out);
                                     });
    if (std::ranges::find(types, XR_REFERENCE_SPACE_TYPE_STAGE) != types.end())
      base_type_ = XR_REFERENCE_SPACE_TYPE_STAGE;
  }
  base_ = make_space(session_, base_type_);
  view_ = make_space(session_, XR_REFERENCE_SPACE_TYPE_VIEW);
}

void Session::make_eyes(const Instance& instance, XrSystemId headset, const SessionOptions& options) {
  XrViewConfigurationView empty{};
  empty.type = XR_TYPE_VIEW_CONFIGURATION_VIEW;
  const auto views = listed<XrViewConfigurationView>(
      "xrEnumerateViewConfigurationViews", empty,
      [&](std::uint32_t room, std::uint32_t* count, XrViewConfigurationView* out) {
        return xrEnumerateViewConfigurationViews(instance.get(), headset, kStereo, room, count, out);
      });
  if (views.size() != 2) throw CallFailed(XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED, "no view for each eye");
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& view = views[i];
    const int width = scaled(view.recommendedImageRectWidth, view.maxImageRectWidth, options);
    const int height = scaled(view.recommendedImageRectHeight, view.maxImageRectHeight, options);
    if (width < 1 || height < 1) throw CallFailed(XR_ERROR_SIZE_INSUFFICIENT, "views of no size");
    eyes_[i] = std::make_unique<PictureSwapchain>(session_, format_, width, height);
    views_[i].type = XR_TYPE_VIEW;
  }
}

SessionStep Session::take(XrSessionState state) {
  const auto ours = [state] {
    switch (state) {
      case XR_SESSION_STATE_IDLE: return SessionState::idle;
      case XR_SESSION_STATE_READY: return SessionState::ready;
      case XR_SESSION_STATE_SYNCHRONIZED: return SessionState::synchronized;
      case XR_SESSION_STATE_VISIBLE: return SessionState::visible;
      case XR_SESSION_STATE_FOCUSED: return SessionState::focused;
      case XR_SESSION_STATE_STOPPING: return SessionState::stopping;
      case XR_SESSION_STATE_LOSS_PENDING: return SessionState::loss_pending;
      case XR_SESSION_STATE_EXITING: return SessionState::exiting;
      default: return SessionState::unknown;
    }
  };
  const SessionStep step = steps_.take(ours());
  if (step == SessionStep::begin) {
    XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO, nullptr, kStereo};
    check(xrBeginSession(session_, &info), "xrBeginSession");
  }
  if (step == SessionStep::end) check(xrEndSession(session_), "xrEndSession");
  return step;
}

void Session::space_moves(XrReferenceSpaceType type, XrTime when) {
  if (type == base_type_ && moves_.size() < kMostMoves) moves_.push_back(when);
}

Session::Waited Session::wait() {
  XrFrameState state{};
  state.type = XR_TYPE_FRAME_STATE;
  check(xrWaitFrame(session_, nullptr, &state), "xrWaitFrame");
  check(xrBeginFrame(session_, nullptr), "xrBeginFrame");
  Waited out{state.predictedDisplayTime, state.shouldRender == XR_TRUE, false, false};
  // Subtracted only where both have the same sign and order: a runtime may say any number.
  const bool known = last_ > 0 && out.display_time > 0;
  out.jumped = out.display_time <= 0 || (known && (out.display_time <= last_ || out.display_time - last_ > kJump));
  if (out.jumped) ++counts_.time_jumps;
  last_ = out.display_time;
  while (!moves_.empty() && moves_.front() <= out.display_time) {
    out.moved = true;
    moves_.pop_front();
  }
  counts_.period = Duration{state.predictedDisplayPeriod};
  return out;
}

void Session::end(XrTime display_time, const std::vector<const XrCompositionLayerBaseHeader*>& layers) {
  XrFrameEndInfo info{};
  info.type = XR_TYPE_FRAME_END_INFO;
  info.displayTime = display_time;
  info.environmentBlendMode = blend_;
  info.layerCount = static_cast<std::uint32_t>(layers.size());
  info.layers = layers.data();
  check(xrEndFrame(session_, &info), "xrEndFrame");
  ++counts_.frames;
}

void Session::empty_frame() {
  end(wait().display_time, {});
}

void Session::request_exit() {
  check(xrRequestExitSession(session_), "xrRequestExitSession");
}

std::optional<Pose> Session::head_at(XrTime time) const {
  XrSpaceLocation place{};
  place.type = XR_TYPE_SPACE_LOCATION;
  check(xrLocateSpace(view_, base_, time, &place), "xrLocateSpace");
  if ((place.locationFlags & kPlace) != kPlace) return std::nullopt;
  return pose_of(place.pose);
}

// False: where one of the eyes will be, or what it sees, is not known.
bool Session::locate_eyes(XrTime time, HeadFrame& frame) {
  XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, kStereo, time, base_};
  XrViewState state{};
  state.type = XR_TYPE_VIEW_STATE;
  std::uint32_t count = 0;
  check(xrLocateViews(session_, &info, &state, 2, &count, views_.data()), "xrLocateViews");
  if (count != 2 || (state.viewStateFlags & kViews) != kViews) return false;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto pose = pose_of(views_[i].pose);
    const auto fov = fov_of(views_[i].fov);
    if (!pose || !fov) return false;
    if (!fovs_[i] || !alike(*fovs_[i], *fov, kSameFov)) fovs_[i] = fov;
    frame.eyes[i] = {*pose, *fovs_[i]};
  }
  return true;
}

void Session::frame(const Clock& clock, HeadPainter& painter, HeldControllers& hands) {
  painter.make_way();
  const Waited waited = wait();
  const OperatorTime now{clock.now().ns};
  HeadFrame frame;
  frame.number = counts_.frames;
  frame.space_moved = waited.moved;
  frame.T_space_head = head_at(waited.display_time);
  controllers_->update(
      {now, waited.display_time, base_, frame.T_space_head, steps_.focused(), !waited.moved && !waited.jumped}, hands);
  Layers layers;
  if (waited.draw) {
    if (!locate_eyes(waited.display_time, frame)) frame.T_space_head.reset();
    painter.look(frame);
    if (frame.T_space_head)
      draw_eyes(frame, painter, layers);
    else
      ++counts_.without_pose;
    draw_panels(painter, frame.T_space_head.has_value(), layers);
  }
  end(waited.display_time, layers.all);
}

void Session::draw_eyes(const HeadFrame& frame, HeadPainter& painter, Layers& layers) {
  for (std::size_t i = 0; i < 2; ++i) {
    painter.draw_eye(i, frame.eyes[i], eyes_[i]->acquire());
    eyes_[i]->release();
    layers.eyes[i] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr, views_[i].pose, xr_fov(frame.eyes[i].fov),
                      eyes_[i]->whole()};
  }
  layers.projection = {XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, base_, 2, layers.eyes.data()};
  layers.all.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layers.projection));
  ++counts_.drawn;
}

void Session::draw_panels(HeadPainter& painter, bool head_known, Layers& layers) {
  const auto wanted = painter.panels();
  for (std::size_t i = 0; i < std::min(wanted.size(), panels_.size()); ++i) {
    const Panel& panel = wanted[i];
    if (!panel.shown || panel.width_px < 1 || panel.height_px < 1) continue;
    if (!panel.head_fixed && !head_known) continue;
    auto& picture = panels_[i];
    if (picture && (picture->width() != panel.width_px || picture->height() != panel.height_px)) picture.reset();
    if (!picture) picture = std::make_unique<PictureSwapchain>(session_, format_, panel.width_px, panel.height_px);
    if (panel.changed || !picture->filled()) {
      painter.draw_panel(i, picture->acquire());
      picture->release();
    }
    XrCompositionLayerQuad& quad = layers.quads[i];
    quad = {XR_TYPE_COMPOSITION_LAYER_QUAD,
            nullptr,
            XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT,
            panel.head_fixed ? view_ : base_,
            XR_EYE_VISIBILITY_BOTH,
            picture->whole(),
            xr_pose(panel.T_frame_panel),
            {static_cast<float>(panel.width), static_cast<float>(panel.width * panel.height_px / panel.width_px)}};
    layers.all.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad));
  }
}

}  // namespace foresight::head
