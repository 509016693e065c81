// What the runtime knows; private to it.
#pragma once

#include <deque>
#include <optional>
#include <set>

#include "tests/openxr_runtime/graphics.hpp"
#include "tests/openxr_runtime/runtime.hpp"

#define XR_USE_GRAPHICS_API_OPENGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

namespace foresight::openxr_runtime {

struct Binding {
  std::uint64_t action = 0;
  std::string input;  // below /user/hand/left
  int side = 0;
};

struct Action {
  XrActionType type = XR_ACTION_TYPE_BOOLEAN_INPUT;
  std::uint64_t set = 0;
};

struct Space {
  enum class Kind { view, local, stage, grip } kind = Kind::local;
  int side = 0;
};

struct Swapchain {
  std::uint32_t width = 0, height = 0;
  std::vector<unsigned> textures;
  std::size_t next = 0;
  std::deque<std::uint32_t> acquired;
  bool waited = false;
  std::optional<std::uint32_t> released;
};

struct Frame {
  XrTime time = 0;
  bool begun = false;
  World world;
  std::optional<std::array<XrView, 2>> views;  // as they were told
};

struct Runtime::State {
  mutable std::recursive_mutex mutex;
  Settings settings;
  Counts counts;
  std::vector<std::string> complaints;
  std::uint64_t next_handle = 1;

  std::uint64_t instance = 0;
  bool instance_lost = false, egl_enabled = false, graphics_asked = false;
  std::vector<std::string> paths;
  std::deque<XrEventDataBuffer> events;

  std::uint64_t session = 0;
  std::optional<GivenGraphics> told_by_layer;  // egl_layer.cpp
  void* context = nullptr;
  bool context_is_egl = true;
  XrSessionState session_state = XR_SESSION_STATE_UNKNOWN;
  enum class Worn { off, menu, on } worn = Worn::on;
  bool running = false, session_lost = false, loss_told = false, exit_wanted = false;

  XrTime now = 0;
  std::int64_t jump = 0;
  double stall = 0;
  std::deque<Frame> frames;  // waited for, not ended
  RoomPose origin;           // of LOCAL
  struct Move {
    XrTime when;
    RoomPose by;
  };
  std::optional<Move> move;

  std::map<std::uint64_t, Space> spaces;
  std::map<std::uint64_t, Swapchain> swapchains;
  std::set<std::uint64_t> action_sets;
  std::map<std::uint64_t, Action> actions;
  std::map<std::string, std::vector<Binding>> bindings;  // by profile
  std::set<std::uint64_t> attached;
  bool synced = false;

  World world_at(XrTime time) const;
  XrResult refuse(XrResult result, const std::string& complaint);
  void change_state(XrSessionState next);
  void approach();  // one state nearer to what the headset's place asks for
  XrResult session_problem(XrSession handle, const char* call);
  bool context_current() const;
};

template <typename Handle>
Handle to_handle(std::uint64_t id) {
  return reinterpret_cast<Handle>(id);
}
template <typename Handle>
std::uint64_t from_handle(Handle handle) {
  return reinterpret_cast<std::uint64_t>(handle);
}

inline Runtime::State& here() {
  return runtime().all();
}
const char* name_of(XrSessionState state);

/// Fills a list as OpenXR hands them out.
template <typename T>
XrResult hand_out(const std::vector<T>& all, std::uint32_t room, std::uint32_t* count, T* out) {
  if (!count) return XR_ERROR_VALIDATION_FAILURE;
  *count = static_cast<std::uint32_t>(all.size());
  if (room == 0) return XR_SUCCESS;
  if (room < all.size() || !out) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::size_t i = 0; i < all.size(); ++i) out[i] = all[i];
  return XR_SUCCESS;
}

using Functions = std::map<std::string, PFN_xrVoidFunction>;
void add_instance_functions(Functions& out);
void add_session_functions(Functions& out);
void add_frame_functions(Functions& out);
void add_swapchain_functions(Functions& out);
void add_action_functions(Functions& out);

template <typename F>
PFN_xrVoidFunction as_void(F* function) {
  return reinterpret_cast<PFN_xrVoidFunction>(function);
}

/// A script of faults for a program that the test does not live in (environment variable FORESIGHT_TEST_XR).
void read_script(Runtime::State& state);
/// What it says for a frame, before it is waited for.
void follow_script(std::uint64_t frame);

}  // namespace foresight::openxr_runtime
