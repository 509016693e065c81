// The sound of each cue: a few sine tones, told apart by their number, their way up or down and their pitch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "seat/sound_cues.hpp"

namespace foresight {

inline constexpr int kSoundRate = 44100;  ///< samples a second

struct Tone {
  double hz = 440;       ///< 0: a pause
  double seconds = 0.1;  ///< > 0
};

/// Of a cue; no two cues have the same.
std::span<const Tone> tones_of(Cue cue);

/// Mono samples at kSoundRate: each tone swells and fades, so that nothing clicks. `volume`: 0 .. 1 of full scale.
std::vector<std::int16_t> samples_of(std::span<const Tone> tones, double volume);

}  // namespace foresight
