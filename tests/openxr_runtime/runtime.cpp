#include "tests/openxr_runtime/runtime.hpp"

#include <cmath>
#include <cstring>

#include "tests/openxr_runtime/graphics.hpp"
#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {

RoomPose looking(std::array<float, 3> from, double left, double up) {
  const double cl = std::cos(left / 2), sl = std::sin(left / 2), cu = std::cos(up / 2), su = std::sin(up / 2);
  const auto f = [](double v) { return static_cast<float>(v); };
  return {from, {f(cl * su), f(sl * cu), f(-sl * su), f(cl * cu)}};
}

Runtime& runtime() {
  static Runtime& one = *new Runtime;
  return one;
}

Runtime::Runtime() : state_(new State) {}

void Runtime::reset(const Settings& settings) {
  const std::lock_guard lock(state_->mutex);
  const std::uint64_t handles = state_->next_handle;
  state_->settings = settings;
  state_->counts = {};
  state_->complaints.clear();
  state_->instance_lost = state_->session_lost = state_->loss_told = state_->exit_wanted = false;
  state_->worn = State::Worn::on;
  state_->now = 1'000'000'000;
  state_->jump = 0;
  state_->stall = 0;
  state_->origin = {};
  state_->move.reset();
  state_->next_handle = handles + 1000;
}

void Runtime::set_world(std::function<World(double seconds)> world) {
  const std::lock_guard lock(state_->mutex);
  state_->settings.world = std::move(world);
}

void Runtime::put_on() {
  const std::lock_guard lock(state_->mutex);
  state_->worn = State::Worn::on;
}
void Runtime::open_menu() {
  const std::lock_guard lock(state_->mutex);
  state_->worn = State::Worn::menu;
}
void Runtime::take_off() {
  const std::lock_guard lock(state_->mutex);
  state_->worn = State::Worn::off;
}

void Runtime::plug(bool in) {
  const std::lock_guard lock(state_->mutex);
  state_->settings.headset = in;
  if (in || !state_->session || state_->loss_told) return;
  state_->loss_told = true;
  state_->change_state(XR_SESSION_STATE_LOSS_PENDING);
}

void Runtime::lose_session() {
  const std::lock_guard lock(state_->mutex);
  state_->session_lost = true;
}
void Runtime::lose_instance() {
  const std::lock_guard lock(state_->mutex);
  state_->instance_lost = state_->instance != 0;
}
void Runtime::close_in_menu() {
  const std::lock_guard lock(state_->mutex);
  state_->exit_wanted = true;
}
void Runtime::jump_time(std::int64_t ns) {
  const std::lock_guard lock(state_->mutex);
  state_->jump = ns;
}
void Runtime::stop_frames(double wall_seconds) {
  const std::lock_guard lock(state_->mutex);
  state_->stall = wall_seconds;
}

void Runtime::recentre(const RoomPose& by) {
  const std::lock_guard lock(state_->mutex);
  XrEventDataReferenceSpaceChangePending change{};
  change.type = XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING;
  change.session = to_handle<XrSession>(state_->session);
  change.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
  change.changeTime = state_->now + static_cast<XrTime>(4e9 / state_->settings.rate_hz);
  XrEventDataBuffer event{};
  static_assert(sizeof change <= sizeof event);
  std::memcpy(static_cast<void*>(&event), &change, sizeof change);
  state_->events.push_back(event);
  state_->move = State::Move{change.changeTime, by};
}

Counts Runtime::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}
std::vector<std::string> Runtime::complaints() const {
  const std::lock_guard lock(state_->mutex);
  return state_->complaints;
}
std::string Runtime::state() const {
  const std::lock_guard lock(state_->mutex);
  return name_of(state_->session_state);
}

const char* name_of(XrSessionState state) {
  switch (state) {
    case XR_SESSION_STATE_IDLE: return "IDLE";
    case XR_SESSION_STATE_READY: return "READY";
    case XR_SESSION_STATE_SYNCHRONIZED: return "SYNCHRONIZED";
    case XR_SESSION_STATE_VISIBLE: return "VISIBLE";
    case XR_SESSION_STATE_FOCUSED: return "FOCUSED";
    case XR_SESSION_STATE_STOPPING: return "STOPPING";
    case XR_SESSION_STATE_LOSS_PENDING: return "LOSS_PENDING";
    case XR_SESSION_STATE_EXITING: return "EXITING";
    default: return "UNKNOWN";
  }
}

World Runtime::State::world_at(XrTime time) const {
  return settings.world ? settings.world(1e-9 * static_cast<double>(time)) : World{};
}

XrResult Runtime::State::refuse(XrResult result, const std::string& complaint) {
  constexpr std::size_t kMost = 100;
  if (complaints.size() < kMost) complaints.push_back(complaint);
  return result;
}

void Runtime::State::change_state(XrSessionState next) {
  session_state = next;
  XrEventDataSessionStateChanged change{};
  change.type = XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED;
  change.session = to_handle<XrSession>(session);
  change.state = next;
  change.time = now;
  XrEventDataBuffer event{};
  std::memcpy(static_cast<void*>(&event), &change, sizeof change);
  events.push_back(event);
}

// OpenXR 1.0, section 9.3: one step, once per frame.
void Runtime::State::approach() {
  if (!running || loss_told) return;
  const bool off = worn == Worn::off || exit_wanted, on = worn == Worn::on && !exit_wanted;
  switch (session_state) {
    case XR_SESSION_STATE_READY: return change_state(XR_SESSION_STATE_SYNCHRONIZED);
    case XR_SESSION_STATE_SYNCHRONIZED:
      if (exit_wanted) return change_state(XR_SESSION_STATE_STOPPING);
      if (!off) return change_state(XR_SESSION_STATE_VISIBLE);
      return;
    case XR_SESSION_STATE_VISIBLE:
      if (on) return change_state(XR_SESSION_STATE_FOCUSED);
      if (off) return change_state(XR_SESSION_STATE_SYNCHRONIZED);
      return;
    case XR_SESSION_STATE_FOCUSED:
      if (!on) return change_state(XR_SESSION_STATE_VISIBLE);
      return;
    default: return;
  }
}

XrResult Runtime::State::session_problem(XrSession handle, const char* call) {
  if (instance_lost) return XR_ERROR_INSTANCE_LOST;
  if (session == 0 || from_handle(handle) != session)
    return refuse(XR_ERROR_HANDLE_INVALID, std::string(call) + ": no such session");
  if (session_lost) return XR_ERROR_SESSION_LOST;
  return XR_SUCCESS;
}

bool Runtime::State::context_current() const {
  return context && current_context(context_is_egl) == context;
}

}  // namespace foresight::openxr_runtime
