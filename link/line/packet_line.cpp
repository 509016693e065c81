#include "link/line/packet_line.hpp"

namespace foresight {

void PacketLine::send(RobotTime now, std::span<const std::uint8_t> packet) {
  put(now, packet);
  if (line_.duplicated()) put(now, packet);
}

void PacketLine::put(RobotTime now, std::span<const std::uint8_t> packet) {
  if (const std::optional<RobotTime> arrival = line_.send(now, packet.size() + overhead_))
    packets_.emplace(*arrival, Packet(packet.begin(), packet.end()));
}

std::optional<PacketLine::Packet> PacketLine::receive(RobotTime now) {
  if (packets_.empty() || packets_.begin()->first > now) return std::nullopt;
  Packet packet = std::move(packets_.begin()->second);
  packets_.erase(packets_.begin());
  return packet;
}

std::optional<RobotTime> PacketLine::next() const {
  if (packets_.empty()) return std::nullopt;
  return packets_.begin()->first;
}

}  // namespace foresight
