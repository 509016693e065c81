// Frames: waited for, begun, ended, in that order and no other.
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>
#include <utility>

#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

XrTime period() {
  return static_cast<XrTime>(1e9 / here().settings.rate_hz);
}

// A display's pictures, one each period, from the first that was waited for on: how many have passed since the last
// call; waits for the next one. Who asks late has left some out.
XrTime next_picture(XrTime period_ns) {
  using Wall = std::chrono::steady_clock;
  static const Wall::time_point first = Wall::now();
  static XrTime last = 0;
  const XrTime next = (Wall::now() - first) / std::chrono::nanoseconds(period_ns) + 1;
  std::this_thread::sleep_until(first + next * std::chrono::nanoseconds(period_ns));
  return next - std::exchange(last, next);
}

void let_time_pass() {
  auto& s = here();
  const double stall = std::exchange(s.stall, 0);
  const bool sleeps = s.settings.real_time;
  s.mutex.unlock();  // others may ask meanwhile
  if (stall > 0) std::this_thread::sleep_for(std::chrono::duration<double>(stall));
  const XrTime pictures = sleeps ? next_picture(period()) : 1;
  s.mutex.lock();
  s.now += pictures * period();
  if (s.settings.tick) s.settings.tick(s.now);
}

XrResult wait_frame(XrSession session, const XrFrameWaitInfo*, XrFrameState* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrWaitFrame"); XR_FAILED(wrong)) return wrong;
  if (!s.running) return s.refuse(XR_ERROR_SESSION_NOT_RUNNING, "xrWaitFrame: the session does not run");
  if (!s.frames.empty() && !s.frames.back().begun)
    return s.refuse(XR_ERROR_CALL_ORDER_INVALID, "xrWaitFrame: the frame before was not begun");
  follow_script(s.counts.waited);
  let_time_pass();
  if (s.instance_lost) return XR_ERROR_INSTANCE_LOST;
  if (s.session_lost) return XR_ERROR_SESSION_LOST;
  s.now += std::exchange(s.jump, 0);
  Frame frame;
  frame.time = s.now + 2 * period();
  if (s.move && s.move->when <= frame.time) {
    s.origin = s.move->by;
    s.move.reset();
  }
  frame.world = s.world_at(frame.time);
  s.frames.push_back(frame);
  out->predictedDisplayTime = frame.time;
  out->predictedDisplayPeriod = period();
  const bool seen = s.session_state == XR_SESSION_STATE_VISIBLE || s.session_state == XR_SESSION_STATE_FOCUSED;
  out->shouldRender = seen ? XR_TRUE : XR_FALSE;
  ++s.counts.waited;
  return XR_SUCCESS;
}

XrResult begin_frame(XrSession session, const XrFrameBeginInfo*) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrBeginFrame"); XR_FAILED(wrong)) return wrong;
  if (!s.running) return s.refuse(XR_ERROR_SESSION_NOT_RUNNING, "xrBeginFrame: the session does not run");
  if (s.frames.empty() || s.frames.back().begun)
    return s.refuse(XR_ERROR_CALL_ORDER_INVALID, "xrBeginFrame: no frame was waited for");
  const bool discards = s.frames.size() > 1;
  if (discards) {
    s.frames.pop_front();
    s.complaints.push_back("xrBeginFrame: the frame before was not ended");
  }
  s.frames.back().begun = true;
  ++s.counts.begun;
  return discards ? XR_FRAME_DISCARDED : XR_SUCCESS;
}

bool same(const XrPosef& a, const XrPosef& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// "" where all is well with a part of a picture; its texture then.
std::string check_image(const XrSwapchainSubImage& image, unsigned& texture) {
  auto& s = here();
  const auto chain = s.swapchains.find(from_handle(image.swapchain));
  if (chain == s.swapchains.end()) return "no such images";
  if (!chain->second.released) return "an image that was never released";
  const auto& [offset, extent] = image.imageRect;
  if (offset.x < 0 || offset.y < 0 || extent.width < 1 || extent.height < 1 || image.imageArrayIndex != 0 ||
      offset.x + extent.width > static_cast<int>(chain->second.width) ||
      offset.y + extent.height > static_cast<int>(chain->second.height))
    return "more than the image";
  texture = chain->second.textures[*chain->second.released];
  return {};
}

std::string check_eyes(const XrCompositionLayerProjection& layer, const Frame& frame, ShownFrame& shown) {
  auto& s = here();
  if (!s.spaces.contains(from_handle(layer.space))) return "eyes in no space";
  if (layer.viewCount != 2) return "not two eyes";
  if (!frame.views) return "eyes that were not asked for";
  for (std::size_t i = 0; i < 2; ++i) {
    if (auto wrong = check_image(layer.views[i].subImage, shown.eyes[i]); !wrong.empty()) return wrong;
    if (!same(layer.views[i].pose, (*frame.views)[i].pose)) return "an eye elsewhere than it was said to be";
    const XrFovf& given = layer.views[i].fov;
    const XrFovf& told = (*frame.views)[i].fov;
    if (std::abs(given.angleLeft - told.angleLeft) > 0.02f || std::abs(given.angleUp - told.angleUp) > 0.02f)
      return "an eye that sees something else than it was said to";
  }
  ++s.counts.with_eyes;
  return {};
}

std::string check_panel(const XrCompositionLayerQuad& layer, ShownFrame& shown) {
  auto& s = here();
  if (!s.spaces.contains(from_handle(layer.space))) return "a panel in no space";
  if (!(layer.size.width > 0) || !(layer.size.height > 0)) return "a panel without a size";
  const auto& q = layer.pose.orientation;
  if (!(std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) < 0.01f)) return "a panel without a pose";
  unsigned texture = 0;
  if (auto wrong = check_image(layer.subImage, texture); !wrong.empty()) return wrong;
  shown.panels.push_back(texture);
  return {};
}

std::string check_layer(const XrCompositionLayerBaseHeader& layer, const Frame& frame, ShownFrame& shown) {
  if (layer.type == XR_TYPE_COMPOSITION_LAYER_PROJECTION)
    return check_eyes(reinterpret_cast<const XrCompositionLayerProjection&>(layer), frame, shown);
  if (layer.type == XR_TYPE_COMPOSITION_LAYER_QUAD)
    return check_panel(reinterpret_cast<const XrCompositionLayerQuad&>(layer), shown);
  return "a layer of another kind";
}

XrResult end_frame(XrSession session, const XrFrameEndInfo* info) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrEndFrame"); XR_FAILED(wrong)) return wrong;
  if (!s.running) return s.refuse(XR_ERROR_SESSION_NOT_RUNNING, "xrEndFrame: the session does not run");
  if (s.frames.empty() || !s.frames.front().begun)
    return s.refuse(XR_ERROR_CALL_ORDER_INVALID, "xrEndFrame: no frame was begun");
  if (!s.context_current()) s.complaints.push_back("xrEndFrame: the session's context is not current");
  const Frame frame = s.frames.front();
  s.frames.pop_front();
  if (info->displayTime != frame.time)
    return s.refuse(XR_ERROR_TIME_INVALID, "xrEndFrame: another time than was predicted");
  if (info->environmentBlendMode != XR_ENVIRONMENT_BLEND_MODE_OPAQUE)
    return s.refuse(XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED, "xrEndFrame: blend mode");
  for (const auto& [handle, chain] : s.swapchains)
    if (!chain.acquired.empty()) s.complaints.push_back("xrEndFrame: an image is still acquired");
  ShownFrame shown{frame.time, frame.world, {}, {}};
  if (info->layerCount > 16) return s.refuse(XR_ERROR_LAYER_LIMIT_EXCEEDED, "xrEndFrame: more than 16 layers");
  for (std::uint32_t i = 0; i < info->layerCount; ++i)
    if (auto wrong = check_layer(*info->layers[i], frame, shown); !wrong.empty())
      return s.refuse(XR_ERROR_LAYER_INVALID, "xrEndFrame: " + wrong);
  if (!shown.panels.empty()) ++s.counts.with_panels;
  ++s.counts.ended;
  s.approach();
  if (s.settings.shown) s.settings.shown(shown);
  return XR_SUCCESS;
}

}  // namespace

void add_frame_functions(Functions& out) {
  out["xrWaitFrame"] = as_void(wait_frame);
  out["xrBeginFrame"] = as_void(begin_frame);
  out["xrEndFrame"] = as_void(end_frame);
}

}  // namespace foresight::openxr_runtime
