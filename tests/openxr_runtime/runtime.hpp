// An OpenXR runtime without a headset, for tests: the loader loads it, as any other, by its manifest (XR_RUNTIME_JSON).
//
// Head and controllers are where a test says; time is the runtime's own, a step per xrWaitFrame. It is strict where a
// runtime may be: order of calls, times that poses are asked for, states, images, paths. What it does not like it
// refuses as the OpenXR 1.0 specification says, and keeps a complaint of. Faults come when a test asks for them; a
// program of its own is told by the environment (script.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace foresight::openxr_runtime {

/// In the axes of OpenXR: x right, y up, z backwards; m; quaternion x y z w.
struct RoomPose {
  std::array<float, 3> position{0, 0, 0};
  std::array<float, 4> orientation{0, 0, 0, 1};
};
/// Turned about the vertical, to the left, and then up; rad.
RoomPose looking(std::array<float, 3> from, double left, double up = 0);

enum class Seen { tracked, inferred, lost, no_number };

struct SimulatedController {
  bool on = true;
  Seen seen = Seen::tracked;
  RoomPose pose;
  float squeeze = 0, trigger = 0, stick_x = 0, stick_y = 0;
  bool stick_pressed = false, first_button = false, menu = false;
};

struct World {
  Seen head_seen = Seen::tracked;
  RoomPose head;
  std::array<SimulatedController, 2> hands;
};

/// A frame as it was handed in: names of textures in the session's context, 0 where there is none.
struct ShownFrame {
  std::int64_t display_time = 0;  ///< ns
  World world;                    ///< of that time
  std::array<unsigned, 2> eyes{};
  std::vector<unsigned> panels;
};

struct Settings {
  bool opengl = true, egl = true;  ///< extensions
  bool headset = true;             ///< is plugged in
  std::uint32_t width = 64, height = 64;
  double rate_hz = 90;
  bool real_time = false;                                ///< xrWaitFrame sleeps until the frame's time
  double eye_distance = 0.063;                           ///< m
  std::array<float, 4> fov{-0.8f, 0.7f, 0.75f, -0.75f};  ///< left eye: left right up down, rad; the right one mirrored
  std::string profile = "/interaction_profiles/oculus/touch_controller";
  std::string srgb = "yes";                    ///< "no": only linear formats
  std::function<World(double seconds)> world;  ///< of the display time; empty: all rests
  /// Called within xrWaitFrame with the runtime's new time, ns.
  std::function<void(std::int64_t now)> tick;
  std::function<void(const ShownFrame&)> shown;  ///< within xrEndFrame, the context current
};

struct Counts {
  std::uint64_t instances = 0, sessions = 0;
  std::uint64_t waited = 0, begun = 0, ended = 0, with_eyes = 0, with_panels = 0;
  std::uint64_t poses = 0;           ///< asked for: eyes, head, hands
  std::uint64_t poses_off_time = 0;  ///< of these not after xrWaitFrame, or not for its predicted time
};

/// What tests see of it. Any thread.
class Runtime {
 public:
  void reset(const Settings& settings);  ///< between instances
  void set_world(std::function<World(double seconds)> world);

  void put_on();     ///< the headset: pictures are seen, controllers are the program's
  void open_menu();  ///< pictures are seen, controllers are the runtime's
  void take_off();
  void plug(bool in);    ///< false: the session is lost, with an event before
  void lose_session();   ///< at once, without a word before
  void lose_instance();  ///< the runtime dies; the next instance finds it alive
  void close_in_menu();  ///< the operator ends the program there
  void jump_time(std::int64_t ns);
  void recentre(const RoomPose& by);      ///< the origin goes there with the next frame but two
  void stop_frames(double wall_seconds);  ///< the next xrWaitFrame takes so long

  Counts counts() const;
  std::vector<std::string> complaints() const;
  std::string state() const;  ///< of the session: "FOCUSED"

  struct State;
  State& all() const { return *state_; }
  Runtime();

 private:
  State* state_;  // as long as the process: programs may end before they let go
};

/// The one of this process.
Runtime& runtime();

}  // namespace foresight::openxr_runtime
