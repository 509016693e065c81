#include "seat/seat_sounds.hpp"

#include "seat/seat_keys.hpp"

namespace foresight {

SeatSounds::SeatSounds(bool on) {
  if (on) speaker_.emplace();
}

void SeatSounds::hear(const SeatStatus& status, const HandSight& hand, bool trusted, double now_s) {
  if (!speaker_) return;
  Hearing hearing;
  hearing.held = status.held;
  hearing.engaged = status.engaged;
  hearing.stopped = status.robot && status.robot->phase.label == "stopped";
  hearing.trusted = trusted;
  if (hand.touch.ghost.reason == GhostReason::contact) hearing.touching = hand.touch.ghost.words;
  hearing.carried = hand.touch.carried;
  hearing.asking = status.robot_control.asking_name;
  for (const Cue cue : cues_.at(hearing, now_s)) speaker_->play(cue);
}

void SeatSounds::toggle() {
  if (speaker_)
    speaker_->mute(!speaker_->muted());
  else
    speaker_.emplace();
}

std::vector<SeatLine> SeatSounds::lines() const {
  if (speaker_ && !speaker_->silent_because().empty())
    return {{"sounds", speaker_->silent_because(), "", Urgency::fine}};
  if (speaker_ && !speaker_->muted()) return {};
  return {
      {"sounds", "off", std::string(speaker_ ? "on again (" : "on (") + printed(SeatKey::sounds) + ")", Urgency::fine}};
}

}  // namespace foresight
