// Sounds by SDL, as far as this machine has any.
#pragma once

#include <memory>
#include <string>

#include "seat/sound_cues.hpp"

namespace foresight {

/// Never waits, and never throws: without a device it is silent, and says why. One thread.
class Speaker {
 public:
  /// `volume`: 0 .. 1.
  explicit Speaker(double volume = 0.25);
  ~Speaker();
  Speaker(const Speaker&) = delete;

  /// Follows what is playing; where much waits already, it is left out: what is late tells the wrong thing.
  void play(Cue cue);
  void mute(bool muted);
  bool muted() const { return muted_; }
  /// Why nothing is heard, and what to do; "" where it is.
  const std::string& silent_because() const { return silent_because_; }
  /// Of what is not played yet.
  double waiting_s() const;

 private:
  struct Device;
  std::unique_ptr<Device> device_;  // null: none
  double volume_;
  bool muted_ = false;
  std::string silent_because_;
};

}  // namespace foresight
