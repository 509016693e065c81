// Bytes on their way as somebody beside the sender counts them, who sees nothing but packets pass: what the sender says
// about itself is held against it.
#pragma once

#include <deque>
#include <map>

#include "link/send_control/packets.hpp"

namespace foresight {

/// One thread.
class WireCount {
 public:
  /// A packet leaves the sender, and is not going to be lost: of one that is, the sender cannot know.
  void leaves(std::span<const std::uint8_t> packet);
  /// A packet comes back to it.
  void comes(std::span<const std::uint8_t> packet, RobotTime now);

  /// Bytes that left and were not acknowledged; without those of which no acknowledgement can tell any more.
  std::size_t unacknowledged() const { return unacknowledged_; }
  /// Bytes whose acknowledgement came within `recent`.
  std::size_t acknowledged_within(Duration recent, RobotTime now);

 private:
  void acknowledge(std::uint32_t sequence, RobotTime now);

  std::map<std::uint32_t, std::size_t> on_the_way_;  // by sequence, the bytes
  std::size_t unacknowledged_ = 0;
  struct Came {
    RobotTime at;
    std::size_t bytes = 0;
  };
  std::deque<Came> came_;
};

}  // namespace foresight
