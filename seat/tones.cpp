#include "seat/tones.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foresight {
namespace {

constexpr double kSwell = 0.008, kFade = 0.030;  // s
constexpr double kFullScale = 32767;

// Up is good, down is not; what is urgent repeats.
constexpr Tone kFollows[] = {{523, 0.07}, {784, 0.11}};
constexpr Tone kAtRest[] = {{784, 0.07}, {523, 0.11}};
constexpr Tone kLost[] = {{660, 0.12}, {440, 0.12}, {660, 0.12}, {440, 0.20}};
constexpr Tone kStopped[] = {{330, 0.18}, {0, 0.06}, {330, 0.18}, {0, 0.06}, {330, 0.30}};
constexpr Tone kViewLost[] = {{494, 0.12}, {370, 0.20}};
constexpr Tone kViewBack[] = {{370, 0.10}, {494, 0.16}};
constexpr Tone kTouches[] = {{196, 0.09}};
constexpr Tone kHolds[] = {{262, 0.06}, {0, 0.03}, {262, 0.06}};
constexpr Tone kLetsGo[] = {{262, 0.06}, {0, 0.03}, {175, 0.08}};
constexpr Tone kAskedFor[] = {{880, 0.10}, {0, 0.08}, {880, 0.10}, {0, 0.08}, {1047, 0.16}};

void append(std::vector<std::int16_t>& out, const Tone& tone, double volume) {
  const auto count = static_cast<std::size_t>(std::lround(tone.seconds * kSoundRate));
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / kSoundRate, left = tone.seconds - t;
    const double envelope = std::clamp(std::min(t / kSwell, left / kFade), 0.0, 1.0);
    const double wave = tone.hz > 0 ? std::sin(2 * std::numbers::pi * tone.hz * t) : 0;
    out.push_back(static_cast<std::int16_t>(std::lround(kFullScale * volume * envelope * wave)));
  }
}

}  // namespace

std::span<const Tone> tones_of(Cue cue) {
  switch (cue) {
    case Cue::follows: return kFollows;
    case Cue::at_rest: return kAtRest;
    case Cue::lost: return kLost;
    case Cue::stopped: return kStopped;
    case Cue::view_lost: return kViewLost;
    case Cue::view_back: return kViewBack;
    case Cue::touches: return kTouches;
    case Cue::holds: return kHolds;
    case Cue::lets_go: return kLetsGo;
    case Cue::asked_for: return kAskedFor;
  }
  return {};
}

std::vector<std::int16_t> samples_of(std::span<const Tone> tones, double volume) {
  std::vector<std::int16_t> out;
  for (const Tone& tone : tones) append(out, tone, std::clamp(volume, 0.0, 1.0));
  return out;
}

}  // namespace foresight
