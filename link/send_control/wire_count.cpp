#include "link/send_control/wire_count.hpp"

namespace foresight {

void WireCount::leaves(std::span<const std::uint8_t> packet) {
  const auto parsed = parse_packet(packet);
  if (const auto* piece = std::get_if<Piece>(&parsed)) {
    on_the_way_[piece->sequence] = packet.size();
  } else if (const auto* question = std::get_if<Question>(&parsed)) {
    on_the_way_[question->sequence] = packet.size();
  } else {
    return;
  }
  unacknowledged_ += packet.size();
}

void WireCount::acknowledge(std::uint32_t sequence, RobotTime now) {
  const auto sent = on_the_way_.find(sequence);
  if (sent == on_the_way_.end()) return;
  came_.push_back({now, sent->second});
  unacknowledged_ -= sent->second;
  on_the_way_.erase(sent);
}

void WireCount::comes(std::span<const std::uint8_t> packet, RobotTime now) {
  const auto parsed = parse_packet(packet);
  const auto* told = std::get_if<Acknowledgement>(&parsed);
  if (!told) return;
  acknowledge(told->newest, now);
  for (std::size_t i = 0; i < Acknowledgement::kBefore; ++i)
    if (told->before[i]) acknowledge(told->newest - 1 - static_cast<std::uint32_t>(i), now);
  while (!on_the_way_.empty() && on_the_way_.begin()->first + Acknowledgement::kBefore < told->newest) {
    unacknowledged_ -= on_the_way_.begin()->second;
    on_the_way_.erase(on_the_way_.begin());
  }
}

std::size_t WireCount::acknowledged_within(Duration recent, RobotTime now) {
  while (!came_.empty() && now - came_.front().at > recent) came_.pop_front();
  std::size_t bytes = 0;
  for (const Came& one : came_) bytes += one.bytes;
  return bytes;
}

}  // namespace foresight
