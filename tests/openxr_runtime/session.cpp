// Sessions, their spaces, and where things are.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/openxr_runtime/graphics.hpp"
#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

XrResult create_session(XrInstance instance, const XrSessionCreateInfo* info, XrSession* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (s.instance_lost) return XR_ERROR_INSTANCE_LOST;
  if (from_handle(instance) != s.instance)
    return s.refuse(XR_ERROR_HANDLE_INVALID, "xrCreateSession: no such instance");
  if (!s.settings.headset) return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  if (s.session) return s.refuse(XR_ERROR_LIMIT_REACHED, "a second session");
  if (!s.graphics_asked)
    return s.refuse(XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING, "a session before its graphics requirements");
  const GivenGraphics given = s.told_by_layer.value_or(given_graphics(info->next));
  if (*given.wrong) return s.refuse(XR_ERROR_GRAPHICS_DEVICE_INVALID, given.wrong);
  if (given.egl && !s.egl_enabled)
    return s.refuse(XR_ERROR_GRAPHICS_DEVICE_INVALID, "an EGL context without XR_MNDX_egl_enable");
  s.context = given.context;
  s.context_is_egl = given.egl;
  if (!s.context_current()) s.complaints.push_back("xrCreateSession: its context is not current");
  s.session = s.next_handle++;
  s.session_lost = s.loss_told = s.exit_wanted = s.running = s.synced = false;
  s.frames.clear();
  s.spaces.clear();
  s.swapchains.clear();
  s.attached.clear();
  ++s.counts.sessions;
  s.change_state(XR_SESSION_STATE_IDLE);
  s.change_state(XR_SESSION_STATE_READY);
  *out = to_handle<XrSession>(s.session);
  return XR_SUCCESS;
}

XrResult destroy_session(XrSession session) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (s.session == 0 || from_handle(session) != s.session)
    return s.refuse(XR_ERROR_HANDLE_INVALID, "xrDestroySession: no such session");
  if (!s.swapchains.empty()) s.complaints.push_back("xrDestroySession: its images were not given back before");
  s.session = 0;
  s.running = false;
  s.session_state = XR_SESSION_STATE_UNKNOWN;
  return XR_SUCCESS;
}

XrResult begin_session(XrSession session, const XrSessionBeginInfo* info) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrBeginSession"); XR_FAILED(wrong)) return wrong;
  if (s.running) return s.refuse(XR_ERROR_SESSION_RUNNING, "xrBeginSession: it has begun");
  if (s.session_state != XR_SESSION_STATE_READY)
    return s.refuse(XR_ERROR_SESSION_NOT_READY, "xrBeginSession: not READY");
  if (info->primaryViewConfigurationType != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO)
    return s.refuse(XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED, "xrBeginSession: not in stereo");
  s.running = true;
  return XR_SUCCESS;
}

XrResult end_session(XrSession session) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrEndSession"); XR_FAILED(wrong)) return wrong;
  if (!s.running) return s.refuse(XR_ERROR_SESSION_NOT_RUNNING, "xrEndSession: it does not run");
  if (s.session_state != XR_SESSION_STATE_STOPPING)
    return s.refuse(XR_ERROR_SESSION_NOT_STOPPING, "xrEndSession: not STOPPING");
  s.running = false;
  s.frames.clear();
  s.change_state(XR_SESSION_STATE_IDLE);
  if (s.exit_wanted) s.change_state(XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

XrResult request_exit(XrSession session) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrRequestExitSession"); XR_FAILED(wrong)) return wrong;
  if (!s.running) return s.refuse(XR_ERROR_SESSION_NOT_RUNNING, "xrRequestExitSession: it does not run");
  s.exit_wanted = true;
  return XR_SUCCESS;
}

XrResult reference_spaces(XrSession session, std::uint32_t room, std::uint32_t* count, XrReferenceSpaceType* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrEnumerateReferenceSpaces"); XR_FAILED(wrong)) return wrong;
  return hand_out<XrReferenceSpaceType>(
      {XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL, XR_REFERENCE_SPACE_TYPE_STAGE}, room, count, out);
}

XrResult add_space(const Space& space, XrSpace* out) {
  auto& s = here();
  s.spaces[s.next_handle] = space;
  *out = to_handle<XrSpace>(s.next_handle++);
  return XR_SUCCESS;
}

XrResult create_reference_space(XrSession session, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrCreateReferenceSpace"); XR_FAILED(wrong)) return wrong;
  const auto& q = info->poseInReferenceSpace.orientation;
  if (std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) > 0.01f)
    return s.refuse(XR_ERROR_POSE_INVALID, "xrCreateReferenceSpace: no unit quaternion");
  switch (info->referenceSpaceType) {
    case XR_REFERENCE_SPACE_TYPE_VIEW: return add_space({Space::Kind::view, 0}, out);
    case XR_REFERENCE_SPACE_TYPE_LOCAL: return add_space({Space::Kind::local, 0}, out);
    case XR_REFERENCE_SPACE_TYPE_STAGE: return add_space({Space::Kind::stage, 0}, out);
    default: return s.refuse(XR_ERROR_REFERENCE_SPACE_UNSUPPORTED, "xrCreateReferenceSpace: no such space");
  }
}

XrResult create_action_space(XrSession session, const XrActionSpaceCreateInfo* info, XrSpace* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrCreateActionSpace"); XR_FAILED(wrong)) return wrong;
  const auto action = s.actions.find(from_handle(info->action));
  if (action == s.actions.end() || action->second.type != XR_ACTION_TYPE_POSE_INPUT)
    return s.refuse(XR_ERROR_ACTION_TYPE_MISMATCH, "xrCreateActionSpace: not of a pose");
  if (info->subactionPath == 0 || info->subactionPath > s.paths.size())
    return s.refuse(XR_ERROR_PATH_INVALID, "xrCreateActionSpace: of neither hand");
  return add_space({Space::Kind::grip, s.paths[info->subactionPath - 1] == "/user/hand/left" ? 0 : 1}, out);
}

XrResult destroy_space(XrSpace space) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (s.session == 0 || s.spaces.erase(from_handle(space)) == 0)
    return s.refuse(XR_ERROR_HANDLE_INVALID, "xrDestroySpace: no such space");
  return XR_SUCCESS;
}

// By the origin: only turned about the vertical and moved, which is all that recentring does.
XrPosef by(const RoomPose& origin, const RoomPose& pose) {
  const auto& o = origin.orientation;
  const double turn = 2 * std::atan2(o[1], o[3]), c = std::cos(-turn), n = std::sin(-turn);
  const double x = pose.position[0] - origin.position[0], z = pose.position[2] - origin.position[2];
  const RoomPose back = looking({}, -turn);
  const auto& a = back.orientation;
  const auto& b = pose.orientation;
  XrPosef out;
  out.position = {static_cast<float>(c * x + n * z), pose.position[1] - origin.position[1],
                  static_cast<float>(-n * x + c * z)};
  out.orientation = {a[3] * b[0] + a[1] * b[2], a[3] * b[1] + a[1] * b[3], a[3] * b[2] - a[1] * b[0],
                     a[3] * b[3] - a[1] * b[1]};
  return out;
}

void break_numbers(XrPosef& pose) {
  pose.position.y = std::numeric_limits<float>::quiet_NaN();
  pose.orientation.w = std::numeric_limits<float>::infinity();
}

XrSpaceLocationFlags flags_of(Seen seen) {
  constexpr XrSpaceLocationFlags kValid =
      XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  constexpr XrSpaceLocationFlags kTracked =
      XR_SPACE_LOCATION_POSITION_TRACKED_BIT | XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
  if (seen == Seen::lost) return 0;
  return seen == Seen::inferred ? kValid : kValid | kTracked;
}

// Poses are to be asked for after xrWaitFrame, for the time that it predicted; null, and a count, where not.
Frame* frame_of(XrTime time) {
  auto& s = here();
  ++s.counts.poses;
  const auto found = std::ranges::find(s.frames, time, &Frame::time);
  if (found != s.frames.end()) return &*found;
  ++s.counts.poses_off_time;
  return nullptr;
}

const RoomPose& origin_of(const Space& space) {
  static const RoomPose none;
  return space.kind == Space::Kind::local ? here().origin : none;
}

XrResult locate_space(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (s.instance_lost) return XR_ERROR_INSTANCE_LOST;
  if (s.session_lost) return XR_ERROR_SESSION_LOST;
  const auto what = s.spaces.find(from_handle(space)), from = s.spaces.find(from_handle(base));
  if (what == s.spaces.end() || from == s.spaces.end())
    return s.refuse(XR_ERROR_HANDLE_INVALID, "xrLocateSpace: no such space");
  if (time <= 0) return s.refuse(XR_ERROR_TIME_INVALID, "xrLocateSpace: no time");
  const Frame* const frame = frame_of(time);
  const World world = frame ? frame->world : s.world_at(time);
  const bool is_hand = what->second.kind == Space::Kind::grip;
  const auto& hand = world.hands[static_cast<std::size_t>(what->second.side)];
  const Seen seen = is_hand ? (hand.on && s.synced ? hand.seen : Seen::lost) : world.head_seen;
  out->locationFlags = flags_of(seen);
  out->pose = by(origin_of(from->second), is_hand ? hand.pose : world.head);
  if (seen == Seen::no_number) break_numbers(out->pose);
  return XR_SUCCESS;
}

XrResult locate_views(XrSession session, const XrViewLocateInfo* info, XrViewState* state, std::uint32_t room,
                      std::uint32_t* count, XrView* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrLocateViews"); XR_FAILED(wrong)) return wrong;
  const auto space = s.spaces.find(from_handle(info->space));
  if (space == s.spaces.end()) return s.refuse(XR_ERROR_HANDLE_INVALID, "xrLocateViews: no such space");
  if (info->displayTime <= 0) return s.refuse(XR_ERROR_TIME_INVALID, "xrLocateViews: no time");
  *count = 2;
  if (room == 0) return XR_SUCCESS;
  if (room < 2) return XR_ERROR_SIZE_INSUFFICIENT;
  Frame* const frame = frame_of(info->displayTime);
  const World world = frame ? frame->world : s.world_at(info->displayTime);
  state->viewStateFlags = flags_of(world.head_seen);  // both have the same bits
  const auto& q = world.head.orientation;
  for (std::uint32_t i = 0; i < 2; ++i) {
    if (out[i].type != XR_TYPE_VIEW) return s.refuse(XR_ERROR_VALIDATION_FAILURE, "xrLocateViews: the type of a view");
    const auto half = static_cast<float>((i == 0 ? -0.5 : 0.5) * s.settings.eye_distance);
    RoomPose eye = world.head;  // along the head's x
    eye.position[0] += half * (1 - 2 * (q[1] * q[1] + q[2] * q[2]));
    eye.position[1] += half * 2 * (q[0] * q[1] + q[3] * q[2]);
    eye.position[2] += half * 2 * (q[0] * q[2] - q[3] * q[1]);
    out[i].pose = by(origin_of(space->second), eye);
    const auto& f = s.settings.fov;
    out[i].fov = i == 0 ? XrFovf{f[0], f[1], f[2], f[3]} : XrFovf{-f[1], -f[0], f[2], f[3]};
    if (world.head_seen == Seen::no_number) break_numbers(out[i].pose);
  }
  if (frame) frame->views = {out[0], out[1]};
  return XR_SUCCESS;
}

}  // namespace

void add_session_functions(Functions& out) {
  out["xrCreateSession"] = as_void(create_session);
  out["xrDestroySession"] = as_void(destroy_session);
  out["xrBeginSession"] = as_void(begin_session);
  out["xrEndSession"] = as_void(end_session);
  out["xrRequestExitSession"] = as_void(request_exit);
  out["xrEnumerateReferenceSpaces"] = as_void(reference_spaces);
  out["xrCreateReferenceSpace"] = as_void(create_reference_space);
  out["xrCreateActionSpace"] = as_void(create_action_space);
  out["xrDestroySpace"] = as_void(destroy_space);
  out["xrLocateSpace"] = as_void(locate_space);
  out["xrLocateViews"] = as_void(locate_views);
}

}  // namespace foresight::openxr_runtime
