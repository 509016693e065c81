// Bytes on their way as somebody beside the sender counts them, who sees nothing but packets pass: what the sender says
// about itself is held against it.
#pragma once

#include <deque>
#include <map>

#include "link/send_control/packets.hpp"

namespace foresight {

/// A piece counts once, however often it was sent, until an acknowledgement of any of its packets has come. One thread.
class WireCount {
 public:
  /// A packet leaves the sender, and is not going to be lost: of one that is, the sender cannot know.
  void leaves(std::span<const std::uint8_t> packet);
  /// A packet comes back to it.
  void comes(std::span<const std::uint8_t> packet, RobotTime now);

  /// Bytes that left and were not acknowledged; without those of which no acknowledgement can tell any more.
  std::size_t unacknowledged() const;
  /// Bytes whose acknowledgement came within `recent`.
  std::size_t acknowledged_within(Duration recent, RobotTime now);

 private:
  using Name = std::pair<std::uint32_t, std::uint32_t>;  // of the pair, and the index in it; of no pair, the sequence
  void acknowledge(std::uint32_t sequence, RobotTime now);

  std::map<std::uint32_t, Name> sent_;          // by sequence
  std::map<Name, std::size_t> unacknowledged_;  // bytes
  struct Came {
    RobotTime at;
    std::size_t bytes = 0;
  };
  std::deque<Came> came_;
};

}  // namespace foresight
