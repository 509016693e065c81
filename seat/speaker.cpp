#include "seat/speaker.hpp"

#include <SDL2/SDL.h>

#include <algorithm>
#include <deque>

#include "common/held_stderr.hpp"
#include "seat/tones.hpp"

namespace foresight {
namespace {

constexpr double kMostWaiting = 1.2;  // s: as much as the longest cue, and half of another
constexpr Uint16 kBlock = 1024;       // samples: 23 ms until one is heard

}  // namespace

// SDL counts who uses it by itself. Its own queue would do, but its thread then gets a stack of 64 kB, on which no
// thread of a program with as many libraries as this one can begin.
struct Speaker::Device {
  SDL_AudioDeviceID id = 0;
  bool opened = false;
  std::deque<std::int16_t> waiting;  // while the device is locked

  Device() {
    const HeldStderr held;  // ALSA says at length that there is no sound card; the seat says it in a line
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_InitSubSystem(SDL_INIT_AUDIO) != 0) return;
    opened = true;
    SDL_AudioSpec wanted{};
    wanted.freq = kSoundRate;
    wanted.format = AUDIO_S16SYS;
    wanted.channels = 1;
    wanted.samples = kBlock;
    wanted.callback = [](void* self, Uint8* out, int bytes) {
      static_cast<Device*>(self)->take({reinterpret_cast<std::int16_t*>(out), bytes / sizeof(std::int16_t)});
    };
    wanted.userdata = this;
    id = SDL_OpenAudioDevice(nullptr, 0, &wanted, nullptr, 0);
    if (id != 0) SDL_PauseAudioDevice(id, 0);
  }
  ~Device() {
    if (id != 0) SDL_CloseAudioDevice(id);
    if (opened) SDL_QuitSubSystem(SDL_INIT_AUDIO);
  }
  Device(const Device&) = delete;

  /// SDL's thread, the device locked.
  void take(std::span<std::int16_t> out) {
    const std::size_t count = std::min(out.size(), waiting.size());
    const auto end = waiting.begin() + static_cast<std::ptrdiff_t>(count);
    std::fill(std::copy(waiting.begin(), end, out.begin()), out.end(), std::int16_t{0});
    waiting.erase(waiting.begin(), end);
  }
  template <typename Change>
  void locked(Change change) {
    SDL_LockAudioDevice(id);
    change(waiting);
    SDL_UnlockAudioDevice(id);
  }
};

Speaker::Speaker(double volume) : device_(std::make_unique<Device>()), volume_(volume) {
  if (device_->id != 0) return;
  silent_because_ =
      std::string("no sound: ") + SDL_GetError() + "; plug a loudspeaker in and start anew, or --no-sounds";
  device_.reset();
}

Speaker::~Speaker() = default;

double Speaker::waiting_s() const {
  std::size_t samples = 0;
  if (device_) device_->locked([&](const auto& waiting) { samples = waiting.size(); });
  return static_cast<double>(samples) / kSoundRate;
}

void Speaker::play(Cue cue) {
  if (!device_ || muted_ || waiting_s() > kMostWaiting) return;
  const std::vector<std::int16_t> samples = samples_of(tones_of(cue), volume_);
  device_->locked([&](auto& waiting) { waiting.insert(waiting.end(), samples.begin(), samples.end()); });
}

void Speaker::mute(bool muted) {
  muted_ = muted;
  if (device_ && muted) device_->locked([](auto& waiting) { waiting.clear(); });
}

}  // namespace foresight
