#include "link/send_control/pair_sender.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "link/send_control/erasure_code.hpp"

namespace foresight {
namespace {

constexpr double kHead_s = 0.010;  // of line time that may still be waiting
// A road is long from a round trip of kFarRoad_s on. What is on it when the line gets slower has to cross before
// anything else does, joint states among it: so a part of it stays empty.
constexpr double kFarRoad_s = 0.130, kFarUse = 0.75;
constexpr double kPrudence = 0.85;  // lines get slower without a word
constexpr double kGrowth = 1.2, kGrowthCalm = 2;
constexpr Duration kCalm = std::chrono::milliseconds(150);    // after which what was measured is old
constexpr Duration kOfUse = std::chrono::milliseconds(1000);  // after which a pair that is mostly lost is given up
constexpr Duration kNeverOfUse = std::chrono::seconds(20);
constexpr std::size_t kMostPending = 64;

constexpr std::size_t pieces_of(std::size_t pair_bytes) {
  return std::max<std::size_t>((pair_bytes + kPieceBytes - 1) / kPieceBytes, 1);
}

}  // namespace

/// Something does in the line, or nothing came back yet to tell. The mean of trips remembers an outage for dozens of
/// them, which are seconds on a thin line: some that found nothing in their way tell more.
bool PairSender::waits() const {
  const auto trip = transmissions_.round_trip(), least = transmissions_.least_round_trip();
  if (!trip) return true;
  return *trip - *least > Transmissions::kNoQueue && transmissions_.known_calm() <= kCalm;
}

double PairSender::road_s() const {
  return to_seconds(transmissions_.least_round_trip().value_or(Duration{}));
}

bool PairSender::is_far() const {
  return road_s() > kFarRoad_s;
}

std::optional<double> PairSender::known_bytes_per_s(RobotTime now) const {
  const bool known = transmissions_.rate(now) || (transmissions_.round_trip() && waits());
  return known ? std::optional(bytes_per_s(now)) : std::nullopt;
}

double PairSender::bytes_per_s(RobotTime now) const {
  const double measured = transmissions_.rate(now).value_or(options_.first_bytes_per_s) * kPrudence;
  if (waits()) return measured;
  // Nothing waits in the line: it carries more than it is given, though pairs of one piece would never show that. Where
  // it has been so for a while, as after a thin time, how much more is found out in larger steps.
  const double given = static_cast<double>(transmissions_.acknowledged_within(Transmissions::kRecent, now)) /
                       to_seconds(Transmissions::kRecent);
  return std::max(measured, (transmissions_.calm(now) > kCalm ? kGrowthCalm : kGrowth) * given);
}

int PairSender::pairs_on_the_way() const {
  return static_cast<int>(
      std::count_if(pending_.begin(), pending_.end(), [](const auto& entry) { return !entry.second.is_whole(); }));
}

bool PairSender::wants_pair(RobotTime now) const {
  if (!fresh_.empty()) return false;
  const std::size_t on_the_way = transmissions_.unacknowledged();
  if (on_the_way > transmissions_.acknowledged_within(transmissions_.of_late(), now)) return false;
  if (transmissions_.lost_lately(now) && pairs_on_the_way() >= options_.most_on_the_way) return false;
  // What is under way on the road itself, both ways, is no queue.
  const double used = is_far() ? std::max(kFarRoad_s, kFarUse * road_s()) : road_s();
  return static_cast<double>(on_the_way) <= bytes_per_s(now) * (used + kHead_s);
}

PairWish PairSender::wish(RobotTime now) const {
  const double rate = bytes_per_s(now);
  const bool far = is_far();
  const double shortest = far ? options_.shortest_far_s : options_.shortest_s;
  const double longest = far ? options_.longest_far_s : options_.longest_s;
  const auto fine = static_cast<double>(far ? options_.fine_far_bytes : options_.fine_bytes);
  const double time = std::clamp(fine / rate, shortest, longest);
  const auto bytes = static_cast<std::size_t>(std::min(rate * time, static_cast<double>(options_.most_bytes)));
  return {.number = last_number_ + 1,
          .bytes = std::max(bytes, options_.least_bytes),
          .only_what_arrived = transmissions_.lost_lately(now)};
}

void PairSender::hand_over(const CodedPair& pair, RobotTime now) {
  Pending pending{.reference = pair.reference, .handed_over = now, .bytes = to_bytes(pair), .spares = {}, .pieces = {}};
  pending.own = pieces_of(pending.bytes.size());
  const std::size_t spares = redundancy_.spares(pending.own, road_s());
  pending.spares = spare_pieces(pending.bytes, spares);
  pending.pieces.resize(pending.own + spares);
  for (std::size_t i = 0; i < pending.pieces.size(); ++i)
    fresh_.emplace_back(pair.number, static_cast<std::uint16_t>(i));
  redundancy_.sent(pair.number, pending.pieces.size());
  last_number_ = std::max(last_number_, pair.number);
  pending_.insert_or_assign(pair.number, std::move(pending));
}

void PairSender::send_piece(std::uint32_t pair, std::uint16_t index, RobotTime now, std::vector<Packet>& out) {
  const auto found = pending_.find(pair);
  if (found == pending_.end() || found->second.pieces[index] != Pending::Is::here) return;
  Pending& pending = found->second;
  Piece piece{.pair = pair, .index = index, .data = pending.piece(index)};
  piece.sequence = transmissions_.send(pair, index, kPieceHeader + piece.data.size(), now);
  piece.count = static_cast<std::uint16_t>(pending.own);
  piece.pair_bytes = static_cast<std::uint32_t>(pending.bytes.size());
  out.push_back(to_packet(piece));
  pending.pieces[index] = Pending::Is::on_the_way;
  ++pending.on_the_way;
}

std::span<const std::uint8_t> PairSender::Pending::piece(std::uint16_t index) const {
  if (index >= own) {
    const std::size_t size = spare_piece_bytes(bytes.size());
    return std::span(spares).subspan((index - own) * size, size);
  }
  const std::size_t begin = index * kPieceBytes;
  return std::span(bytes).subspan(begin, std::min(kPieceBytes, bytes.size() - begin));
}

// A pair goes on to be sent as long as a lane builds on it, which is cheaper to repair than to begin anew. Only where
// it is old and mostly lost, as after an outage, a fresh picture is the better use of the line.
bool PairSender::worth_sending(const Pending& pending, RobotTime now) const {
  const Duration age = now - pending.handed_over;
  return age < kOfUse || (age < kNeverOfUse && 2 * pending.needed() < pending.own);
}

void PairSender::give_up(std::uint32_t pair, PairFates& fates) {
  fates.gone(pair);
  pending_.erase(pair);
  // What builds on it is of no use either.
  for (auto next = pending_.upper_bound(pair); next != pending_.end(); ++next)
    if (next->second.reference == pair) return give_up(next->first, fates);
}

void PairSender::take(std::span<const std::uint8_t> packet, RobotTime now, PairFates& fates) {
  const auto parsed = parse_packet(packet);
  const auto* acknowledgement = std::get_if<Acknowledgement>(&parsed);
  if (!acknowledgement) return;
  for (const Transmissions::Sent& sent : transmissions_.acknowledge(*acknowledgement, now)) {
    redundancy_.came(sent.pair);
    const auto found = pending_.find(sent.pair);
    if (found == pending_.end()) continue;
    Pending& pending = found->second;
    Pending::Is& piece = pending.pieces[sent.index];
    if (piece == Pending::Is::on_the_way) --pending.on_the_way;
    if (piece != Pending::Is::arrived) ++pending.arrived;
    piece = Pending::Is::arrived;
  }
  for (const std::uint32_t pair : acknowledgement->decoded) {
    if (pair > last_number_) continue;
    fates.arrived(pair);
    pending_.erase(pair);
  }
  if (acknowledgement->undecodable > last_undecodable_ && acknowledgement->undecodable <= last_number_) {
    last_undecodable_ = acknowledgement->undecodable;
    give_up(last_undecodable_, fates);
  }
}

/// With spare ones, as these may get lost, too.
void PairSender::send_again(std::uint32_t number, const Pending& pending, RobotTime now, std::vector<Packet>& out) {
  std::size_t left = pending.needed() + redundancy_.spares(pending.needed(), road_s());
  for (std::uint16_t index = 0; index < pending.pieces.size() && left > 0; ++index) {
    if (pending.pieces[index] != Pending::Is::here) continue;
    send_piece(number, index, now, out);
    --left;
  }
}

std::vector<Packet> PairSender::packets(RobotTime now, PairFates& fates) {
  std::vector<Packet> out;
  std::set<std::uint32_t> incomplete;
  for (const Transmissions::Sent& sent : transmissions_.lost(now)) {
    redundancy_.lost(sent.pair);
    const auto found = pending_.find(sent.pair);
    if (found == pending_.end() || found->second.pieces[sent.index] != Pending::Is::on_the_way) continue;
    found->second.pieces[sent.index] = Pending::Is::here;
    --found->second.on_the_way;
    if (found->second.needed() > 0) incomplete.insert(sent.pair);
  }
  for (const std::uint32_t pair : incomplete) {
    const auto found = pending_.find(pair);
    if (found == pending_.end()) continue;  // given up with another
    if (worth_sending(found->second, now)) {
      send_again(pair, found->second, now, out);
    } else {
      give_up(pair, fates);
    }
  }
  for (const auto& [pair, index] : fresh_) send_piece(pair, index, now, out);
  fresh_.clear();
  if (transmissions_.question_due(now))
    out.push_back(to_packet(Question{transmissions_.send(0, 0, to_packet(Question{}).size(), now)}));
  while (pending_.size() > kMostPending) give_up(pending_.begin()->first, fates);
  return out;
}

}  // namespace foresight
