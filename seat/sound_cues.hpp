// What an operator is to hear: events that he must not miss while he looks elsewhere. All of it is on the screen, too.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace foresight {

enum class Cue : std::uint8_t {
  follows,    ///< the robot follows the hand from now on
  at_rest,    ///< the switch was let go of
  lost,       ///< the switch is held, and moves nothing any more
  stopped,    ///< the robot was stopped, or a fault did it
  view_lost,  ///< the newest image stands in for the prediction
  view_back,  ///< and no longer does
  touches,    ///< a part touches that did not
  holds,      ///< the jaws hold something
  lets_go,    ///< and no longer do
  asked_for,  ///< somebody else asks for control
};
inline constexpr int kCues = 10;

/// What there is to hear at one moment.
struct Hearing {
  bool held = false, engaged = false;  ///< the switch is held; it counts (SeatStatus)
  bool stopped = false;                ///< the robot's phase is "stopped"
  bool trusted = true;                 ///< the prediction is shown
  std::string touching;                ///< what touches what; "" nothing
  std::string carried;                 ///< what the jaws hold; "" nothing
  std::string asking;                  ///< who asks for control; "" nobody
};

/// Pure: the same moments give the same cues. One thread.
class SoundCues {
 public:
  /// What is to be heard now, the most urgent first; nothing at the first moment, which is how things are. One that was
  /// heard less than kAgain before is left out, but for `lost` and `stopped`.
  std::vector<Cue> at(const Hearing& hearing, double now_s);

  static constexpr double kAgain = 0.5;  ///< s

 private:
  std::optional<Hearing> before_;
  std::optional<double> told_[kCues];
};

}  // namespace foresight
