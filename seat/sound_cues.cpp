#include "seat/sound_cues.hpp"

#include <utility>

namespace foresight {

std::vector<Cue> SoundCues::at(const Hearing& hearing, double now_s) {
  const std::optional<Hearing> before = std::exchange(before_, hearing);
  std::vector<Cue> out;
  if (!before) return out;
  const auto tell = [&](bool happened, Cue cue) {
    if (!happened) return;
    std::optional<double>& told = told_[static_cast<std::size_t>(cue)];
    const bool urgent = cue == Cue::lost || cue == Cue::stopped;
    if (!urgent && told && now_s - *told < kAgain) return;
    told = now_s;
    out.push_back(cue);
  };
  const auto comes = [](const std::string& was, const std::string& is) { return !is.empty() && is != was; };
  tell(hearing.stopped && !before->stopped, Cue::stopped);
  tell(before->engaged && !hearing.engaged && hearing.held, Cue::lost);
  tell(before->trusted && !hearing.trusted, Cue::view_lost);
  tell(comes(before->asking, hearing.asking), Cue::asked_for);
  tell(comes(before->touching, hearing.touching), Cue::touches);
  tell(comes(before->carried, hearing.carried), Cue::holds);
  tell(!before->carried.empty() && hearing.carried.empty(), Cue::lets_go);
  tell(hearing.engaged && !before->engaged, Cue::follows);
  tell(before->engaged && !hearing.engaged && !hearing.held, Cue::at_rest);
  tell(!before->trusted && hearing.trusted, Cue::view_back);
  return out;
}

}  // namespace foresight
