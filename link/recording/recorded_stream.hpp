// Coded pairs of a recording, whole again.
#pragma once

#include <optional>

#include "link/coding/coded_pair.hpp"
#include "link/messages/foresight_messages.hpp"
#include "link/send_control/pair_receiver.hpp"

namespace foresight::link {

/// Of the reader that the pieces were for; another one, or another start of the robot's program, begins anew. One
/// thread.
class RecordedStream {
 public:
  struct Pair {
    StereoFrame frame;  ///< without data
    StereoPicture picture;
  };
  /// For people, where pieces came and take() has given nothing.
  static constexpr const char* kNothingWhole =
      "no coded pair (h264) could be decoded: too much was lost on the way to the recorder, or an older version of the "
      "robot's program served its operator alone";

  /// The newest pair that can be decoded now; mostly nothing. Takes any piece. `now` must not fall.
  std::optional<Pair> take(const StereoPiece& piece, RobotTime now);

 private:
  struct Source {
    std::uint64_t session = 0, reader = 0;
    std::uint32_t stream = 0;
    bool operator==(const Source&) const = default;
  };
  Source source_;
  std::optional<PairReceiver> receiver_;
};

}  // namespace foresight::link
