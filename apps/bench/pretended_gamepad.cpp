#include "apps/bench/pretended_gamepad.hpp"

#include <SDL2/SDL.h>

#include <algorithm>

#include "common/error.hpp"
#include "input/gamepad.hpp"

namespace foresight {
namespace {

Sint16 as_sdl(double share) {
  return static_cast<Sint16>(std::clamp(share, -1.0, 1.0) * 32767);
}

[[noreturn]] void no_gamepad() {
  throw RuntimeFailure(std::string("SDL pretends no gamepad: ") + SDL_GetError(), "use SDL 2.0.14 or newer");
}

std::shared_ptr<void> start_sdl() {
  if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) no_gamepad();
  return {nullptr, [](void*) { SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER); }};
}

}  // namespace

struct PretendedGamepad::Pad {
  Pad()
      : index(SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                        SDL_CONTROLLER_BUTTON_MAX, 0)),
        stick(index < 0 ? nullptr : SDL_JoystickOpen(index)) {
    if (!stick) no_gamepad();
    axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT, -1);
    axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, -1);
  }
  ~Pad() {
    SDL_JoystickClose(stick);
    SDL_JoystickDetachVirtual(index);
  }
  Pad(const Pad&) = delete;
  Pad& operator=(const Pad&) = delete;
  void axis(SDL_GameControllerAxis which, double share) const {
    SDL_JoystickSetVirtualAxis(stick, which, as_sdl(share));
  }
  int index;
  SDL_Joystick* stick;
};

PretendedGamepad::PretendedGamepad() : sdl_(start_sdl()) {
  index_ = static_cast<std::size_t>(std::ranges::count(find_gamepads(), true, &GamepadFound::known));
  plug(true);
}

PretendedGamepad::~PretendedGamepad() {
  pad_.reset();  // before SDL
}

void PretendedGamepad::plug(bool in) {
  if (in && !pad_) pad_ = std::make_unique<Pad>();
  if (!in) pad_.reset();
}

void PretendedGamepad::move(const PadSticks& sticks) {
  if (!pad_) return;
  pad_->axis(SDL_CONTROLLER_AXIS_LEFTX, sticks.left_x);
  pad_->axis(SDL_CONTROLLER_AXIS_LEFTY, sticks.left_y);
  pad_->axis(SDL_CONTROLLER_AXIS_RIGHTX, sticks.right_x);
  pad_->axis(SDL_CONTROLLER_AXIS_RIGHTY, sticks.right_y);
  SDL_JoystickSetVirtualButton(pad_->stick, SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, sticks.right_shoulder ? 1 : 0);
}

}  // namespace foresight
