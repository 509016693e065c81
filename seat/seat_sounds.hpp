// What an operator hears of his seat.
#pragma once

#include <optional>
#include <vector>

#include "seat/hand_sight.hpp"
#include "seat/seat.hpp"
#include "seat/sound_cues.hpp"
#include "seat/speaker.hpp"

namespace foresight {

/// The window's thread.
class SeatSounds {
 public:
  /// `on`: else no device is opened before toggle() asks for one.
  explicit SeatSounds(bool on);

  /// At each picture. `trusted`: the prediction is shown.
  void hear(const SeatStatus& status, const HandSight& hand, bool trusted, double now_s);
  /// Off, and on again. The first device is opened here where sounds began switched off: it may take a moment.
  void toggle();
  /// For the head-up display: that nothing is heard, and why; nothing where sounds are on.
  std::vector<SeatLine> lines() const;

 private:
  SoundCues cues_;
  std::optional<Speaker> speaker_;  // nothing: never switched on
};

}  // namespace foresight
