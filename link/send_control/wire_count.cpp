#include "link/send_control/wire_count.hpp"

#include <numeric>

namespace foresight {

void WireCount::leaves(std::span<const std::uint8_t> packet) {
  const auto parsed = parse_packet(packet);
  if (const auto* piece = std::get_if<Piece>(&parsed)) {
    unacknowledged_[sent_[piece->sequence] = {piece->pair, piece->index}] = packet.size();
  } else if (const auto* question = std::get_if<Question>(&parsed)) {
    unacknowledged_[sent_[question->sequence] = {0, question->sequence}] = packet.size();
  }
}

void WireCount::acknowledge(std::uint32_t sequence, RobotTime now) {
  const auto sent = sent_.find(sequence);
  if (sent == sent_.end()) return;
  if (const auto bytes = unacknowledged_.find(sent->second); bytes != unacknowledged_.end()) {
    came_.push_back({now, bytes->second});
    unacknowledged_.erase(bytes);
  }
  sent_.erase(sent);
}

void WireCount::comes(std::span<const std::uint8_t> packet, RobotTime now) {
  const auto parsed = parse_packet(packet);
  const auto* told = std::get_if<Acknowledgement>(&parsed);
  if (!told) return;
  acknowledge(told->newest, now);
  for (std::size_t i = 0; i < Acknowledgement::kBefore; ++i)
    if (told->before[i]) acknowledge(told->newest - 1 - static_cast<std::uint32_t>(i), now);
  while (!sent_.empty() && sent_.begin()->first + Acknowledgement::kBefore < told->newest) {
    unacknowledged_.erase(sent_.begin()->second);
    sent_.erase(sent_.begin());
  }
}

std::size_t WireCount::unacknowledged() const {
  return std::accumulate(unacknowledged_.begin(), unacknowledged_.end(), std::size_t{0},
                         [](std::size_t sum, const auto& piece) { return sum + piece.second; });
}

std::size_t WireCount::acknowledged_within(Duration recent, RobotTime now) {
  while (!came_.empty() && now - came_.front().at > recent) came_.pop_front();
  return std::accumulate(came_.begin(), came_.end(), std::size_t{0},
                         [](std::size_t sum, const Came& came) { return sum + came.bytes; });
}

}  // namespace foresight
