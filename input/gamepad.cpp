#include "input/gamepad.hpp"

#include <SDL2/SDL.h>

#include <algorithm>

#include "common/error.hpp"

namespace foresight {
namespace {

// SDL as long as somebody holds it. It counts its users by itself.
std::shared_ptr<void> start_pads() {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");  // it has no window of its own
  if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0)
    throw RuntimeFailure(std::string("SDL finds no gamepads: ") + SDL_GetError(),
                         "see that /dev/input may be read, or use another device");
  // States are asked for; events would only pile up.
  SDL_JoystickEventState(SDL_IGNORE);
  SDL_GameControllerEventState(SDL_IGNORE);
  return {nullptr, [](void*) { SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER); }};
}

void update_pads() {
  SDL_GameControllerUpdate();
  SDL_FlushEvents(SDL_FIRSTEVENT, SDL_LASTEVENT);
}

std::string name_at(int index) {
  const char* const name = SDL_JoystickNameForIndex(index);
  return name ? name : "without a name";
}

double share(Sint16 value) {
  return std::clamp(value / 32767.0, -1.0, 1.0);
}

}  // namespace

std::vector<GamepadFound> find_gamepads() {
  const auto sdl = start_pads();
  update_pads();
  std::vector<GamepadFound> out;
  for (int i = 0, pads = 0; i < SDL_NumJoysticks(); ++i) {
    const bool known = SDL_IsGameController(i) == SDL_TRUE;
    out.push_back({known ? pads++ : -1, name_at(i), known});
  }
  return out;
}

struct Gamepad::Device {
  std::shared_ptr<void> sdl = start_pads();
  std::size_t index = 0;
  SDL_GameController* pad = nullptr;

  ~Device() { close(); }
  void close() noexcept {
    if (pad) SDL_GameControllerClose(pad);
    pad = nullptr;
  }
  void open() noexcept {
    std::size_t pads = 0;
    for (int i = 0; i < SDL_NumJoysticks() && !pad; ++i)
      if (SDL_IsGameController(i) == SDL_TRUE && pads++ == index) pad = SDL_GameControllerOpen(i);
  }
  bool button(SDL_GameControllerButton which) const { return SDL_GameControllerGetButton(pad, which) != 0; }
  double axis(SDL_GameControllerAxis which) const { return share(SDL_GameControllerGetAxis(pad, which)); }
};

Gamepad::Gamepad(std::size_t index, const GamepadOptions& options)
    : device_(std::make_unique<Device>()), options_(options), hand_(options.hand) {
  device_->index = index;
  update_pads();
  device_->open();
}

Gamepad::~Gamepad() = default;

std::vector<std::pair<std::string, std::string>> Gamepad::keys() {
  return {{"right shoulder", "of the gamepad, held: the robot moves"},
          {"left stick", "the tool: forward, left, back, right"},
          {"right stick", "the tool: up, down; it turns left, right"},
          {"left shoulder", "held: the left stick tips and rolls it"},
          {"triggers", "gripper closes (right), opens (left)"},
          {"pad X, B, Y", "single joints; the view as it began; recentre"},
          {"pad cross", "the camera; with single joints: which one"}};
}

std::string Gamepad::name() const {
  const char* const name = device_->pad ? SDL_GameControllerName(device_->pad) : nullptr;
  return name ? std::string("gamepad '") + name + "'" : "gamepad " + std::to_string(device_->index);
}

bool Gamepad::is_stale(OperatorTime now) noexcept {
  State state{};
  static_assert(state.axes.size() == SDL_CONTROLLER_AXIS_MAX && state.buttons.size() == SDL_CONTROLLER_BUTTON_MAX);
  for (int i = 0; i < SDL_CONTROLLER_AXIS_MAX; ++i)
    state.axes[static_cast<std::size_t>(i)] =
        SDL_GameControllerGetAxis(device_->pad, static_cast<SDL_GameControllerAxis>(i));
  for (int i = 0; i < SDL_CONTROLLER_BUTTON_MAX; ++i)
    state.buttons[static_cast<std::size_t>(i)] = device_->button(static_cast<SDL_GameControllerButton>(i));
  if (!changed_ || state != last_) changed_ = now;
  last_ = state;
  return now - *changed_ > options_.stale_after;
}

TrackerState Gamepad::read(OperatorTime now) noexcept {
  update_pads();
  if (device_->pad && SDL_GameControllerGetAttached(device_->pad) != SDL_TRUE) device_->close();
  if (!device_->pad) device_->open();
  TrackerState out;
  out.time = now;
  out.integrated = true;
  if (!device_->pad) {
    out.trouble = "the gamepad is not there";
    out.cure = "plug it in; let go of its shoulder button, and press it again";
    out.T_space_hand = hand_.step(now, {});
    return out;
  }
  out.connected = out.tracked = true;
  const Device& d = *device_;
  const bool stale = is_stale(now);
  const auto pressed = [&](SDL_GameControllerButton which) { return !stale && d.button(which); };
  const auto pulled = [&](SDL_GameControllerAxis which) { return !stale && d.axis(which) > options_.trigger; };
  const auto stick = [&](SDL_GameControllerAxis axis) {
    return stale ? 0 : without_dead_zone(d.axis(axis), options_.dead_zone);
  };
  const double left_x = stick(SDL_CONTROLLER_AXIS_LEFTX), left_y = stick(SDL_CONTROLLER_AXIS_LEFTY);
  const double right_x = stick(SDL_CONTROLLER_AXIS_RIGHTX), right_y = stick(SDL_CONTROLLER_AXIS_RIGHTY);
  const bool turns = d.button(SDL_CONTROLLER_BUTTON_LEFTSHOULDER);
  HandRate rate;
  if (turns)
    rate.angular << left_x, -left_y, -right_x;
  else {
    rate.linear << -left_y, -left_x, -right_y;
    rate.angular.z() = -right_x;
  }
  out.T_space_hand = hand_.step(now, rate);
  const auto set = [&](TrackerButton button, bool held) { out.buttons.set(button, held); };
  const bool holds = d.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER);
  set(TrackerButton::deadman, holds);
  set(TrackerButton::clutch, holds);
  set(TrackerButton::gripper_close, pulled(SDL_CONTROLLER_AXIS_TRIGGERRIGHT));
  set(TrackerButton::gripper_open, pulled(SDL_CONTROLLER_AXIS_TRIGGERLEFT));
  set(TrackerButton::joint_mode, d.button(SDL_CONTROLLER_BUTTON_X));
  set(TrackerButton::home_view, d.button(SDL_CONTROLLER_BUTTON_B));
  set(TrackerButton::recentre, d.button(SDL_CONTROLLER_BUTTON_Y));
  set(TrackerButton::to_start, pressed(SDL_CONTROLLER_BUTTON_START));
  const bool to_left = pressed(SDL_CONTROLLER_BUTTON_DPAD_LEFT), to_right = pressed(SDL_CONTROLLER_BUTTON_DPAD_RIGHT);
  const bool up = pressed(SDL_CONTROLLER_BUTTON_DPAD_UP), down = pressed(SDL_CONTROLLER_BUTTON_DPAD_DOWN);
  set(TrackerButton::previous_joint, to_left);
  set(TrackerButton::next_joint, to_right);
  out.joint_rate = -left_y;
  out.pan_rate = (to_left ? 1.0 : 0.0) - (to_right ? 1.0 : 0.0);
  out.tilt_rate = (up ? 1.0 : 0.0) - (down ? 1.0 : 0.0);
  return out;
}

void Gamepad::push(OperatorTime, const HandContact& contact) noexcept {
  if (!device_->pad) return;
  const double depth = ForceLimits{}.depth;
  const auto strength = static_cast<Uint16>(65535 * std::clamp(contact.depth / depth, 0.0, 1.0));
  SDL_GameControllerRumble(device_->pad, strength, 0, strength > 0 ? 200 : 0);
}

}  // namespace foresight
