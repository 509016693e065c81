// A direction of a line with the packets in it.
#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "link/line/delay_line.hpp"

namespace foresight {

/// Puts packets in at one end and gives them out at the other. One thread.
class PacketLine {
 public:
  using Packet = std::vector<std::uint8_t>;

  /// `overhead`: bytes that each packet has on the line besides its own (headers of UDP and IP).
  PacketLine(const DirectionSpec& spec, RobotTime begin, std::uint64_t seed, std::size_t overhead = 28)
      : line_(spec, begin, seed), overhead_(overhead) {}

  void send(RobotTime now, std::span<const std::uint8_t> packet);
  /// The packet that arrived first by `now` and was not taken yet.
  std::optional<Packet> receive(RobotTime now);
  /// When `receive` has something next; nothing while the line is empty.
  std::optional<RobotTime> next() const;

  std::size_t on_the_way() const { return packets_.size(); }
  const DelayLine& line() const { return line_; }

 private:
  void put(RobotTime now, std::span<const std::uint8_t> packet);

  DelayLine line_;
  std::size_t overhead_;
  std::multimap<RobotTime, Packet> packets_;  // by arrival; of equals the one that was sent first
};

}  // namespace foresight
