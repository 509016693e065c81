#include "link/send_control/pair_receiver.hpp"

#include <algorithm>

#include "link/send_control/erasure_code.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostAssemblies = 32, kMostWaiting = 16, kMostDone = 64;
constexpr std::size_t kMostAssembledBytes = 2 * kLargestCodedPair;
constexpr std::size_t kRepeated = 8;  // arrivals that are told again, as acknowledgements get lost, too

}  // namespace

/// Whether a packet of this sequence comes for the first time; remembers it.
bool PairReceiver::note(std::uint32_t sequence, RobotTime now) {
  if (sequence > newest_) {
    const std::uint32_t ahead = sequence - newest_;
    before_ = ahead < Acknowledgement::kBefore ? before_ << ahead : std::bitset<Acknowledgement::kBefore>();
    if (newest_ > 0 && ahead <= Acknowledgement::kBefore) before_.set(ahead - 1);
    newest_ = sequence;
  } else {
    const std::uint32_t behind = newest_ - sequence;
    if (behind == 0 || behind > Acknowledgement::kBefore || before_[behind - 1]) return false;
    before_.set(behind - 1);
  }
  arrivals_.push_back({sequence, Duration{now.ns}});
  while (arrivals_.size() > Acknowledgement::kMostArrivals) {
    arrivals_.pop_front();
    if (told_ > 0) --told_;
  }
  if (!due_) due_ = last_acknowledged_ ? std::max(now, *last_acknowledged_ + kBetween) : now;
  return true;
}

/// Whether its pair is whole now.
bool PairReceiver::add(const Piece& piece) {
  if (std::find(done_.begin(), done_.end(), piece.pair) != done_.end()) return false;
  Assembly& assembly = assemblies_[piece.pair];
  if (assembly.bytes.empty()) {
    assembly.bytes.resize(piece.pair_bytes);
    assembly.has.resize(piece.count);
    assembly.missing = piece.count;
    assembled_bytes_ += piece.pair_bytes;
  }
  if (assembly.bytes.size() != piece.pair_bytes) return false;
  if (piece.is_spare()) {
    assembly.spares.emplace(piece.index, std::vector<std::uint8_t>(piece.data.begin(), piece.data.end()));
  } else {
    if (assembly.has[piece.index]) return false;
    assembly.has[piece.index] = true;
    std::copy(piece.data.begin(), piece.data.end(),
              assembly.bytes.begin() + static_cast<std::ptrdiff_t>(piece.index * kPieceBytes));
    --assembly.missing;
  }
  if (assembly.missing > assembly.spares.size()) return false;
  if (assembly.missing > 0) restore(assembly);
  return true;
}

void PairReceiver::restore(Assembly& assembly) {
  std::vector<std::uint16_t> missing;
  for (std::size_t i = 0; i < assembly.has.size(); ++i)
    if (!assembly.has[i]) missing.push_back(static_cast<std::uint16_t>(i));
  restore_pieces(assembly.bytes, missing, assembly.spares);
}

/// Nothing that a sender says makes this side remember more than a bound; the oldest goes first.
void PairReceiver::keep_bounds() {
  while (assemblies_.size() > kMostAssemblies || (assemblies_.size() > 1 && assembled_bytes_ > kMostAssembledBytes)) {
    assembled_bytes_ -= assemblies_.begin()->second.bytes.size();
    assemblies_.erase(assemblies_.begin());
  }
  while (waiting_.size() > kMostWaiting) waiting_.erase(waiting_.begin());
  while (done_.size() > kMostDone) done_.pop_front();
  while (decoded_.size() > Acknowledgement::kMostDecoded) decoded_.pop_front();
}

std::vector<ReceivedPair> PairReceiver::take(std::span<const std::uint8_t> packet, RobotTime now) {
  if (!receive(packet, now)) return {};
  return decode();
}

bool PairReceiver::receive(std::span<const std::uint8_t> packet, RobotTime now) {
  const auto parsed = parse_packet(packet);
  if (const auto* question = std::get_if<Question>(&parsed)) {
    note(question->sequence, now);
    return false;
  }
  const auto* piece = std::get_if<Piece>(&parsed);
  if (!piece || !note(piece->sequence, now) || !add(*piece)) {
    keep_bounds();
    return false;
  }
  const auto whole = assemblies_.find(piece->pair);
  std::optional<CodedPair> pair = parse_coded_pair(whole->second.bytes);
  assembled_bytes_ -= whole->second.bytes.size();
  assemblies_.erase(whole);
  done_.push_back(piece->pair);
  if (pair && pair->number == piece->pair) {
    waiting_.insert_or_assign(pair->number, std::move(*pair));
  } else {
    undecodable_ = piece->pair;
  }
  due_ = now;
  return true;
}

std::vector<ReceivedPair> PairReceiver::decode() {
  std::vector<ReceivedPair> out = decode_ready();
  keep_bounds();
  if (!due_) due_ = last_acknowledged_;  // what was decoded is to be told, too
  return out;
}

/// Whether a pair that is not here is over and done with, or from before this receiver began.
bool PairReceiver::never_comes(std::uint32_t pair) const {
  if (waiting_.contains(pair) || assemblies_.contains(pair)) return false;
  return std::find(done_.begin(), done_.end(), pair) != done_.end() || (!done_.empty() && pair < done_.front());
}

std::vector<ReceivedPair> PairReceiver::decode_ready() {
  std::vector<ReceivedPair> out;
  for (auto next = waiting_.begin(); next != waiting_.end();) {
    if (!decoder_->ready(next->second)) {
      if (!never_comes(next->second.reference)) {
        ++next;
        continue;
      }
      undecodable_ = std::max(undecodable_, next->first);
      next = waiting_.erase(next);
      continue;
    }
    CodedPair pair = std::move(next->second);
    waiting_.erase(next);
    if (std::optional<StereoPicture> picture = decoder_->decode(pair)) {
      decoded_.push_back(pair.number);
      const bool newest = !newest_captured_ || pair.captured > *newest_captured_;
      if (newest) newest_captured_ = pair.captured;
      const std::size_t bytes = pair.data.size() + pair.notes.size() + kCodedPairHeader;
      out.push_back({pair.number, bytes, std::move(*picture), std::move(pair.notes), newest});
    } else {
      undecodable_ = std::max(undecodable_, pair.number);
    }
    next = waiting_.begin();  // others may build on it
  }
  return out;
}

Packet PairReceiver::acknowledge(RobotTime now) {
  if (!due_ || now < *due_ || arrivals_.empty()) return {};
  Acknowledgement out;
  out.newest = newest_;
  out.before = before_;
  const std::size_t first = told_ > kRepeated ? told_ - kRepeated : 0;
  out.arrivals.assign(arrivals_.begin() + static_cast<std::ptrdiff_t>(first), arrivals_.end());
  out.decoded.assign(decoded_.begin(), decoded_.end());
  out.undecodable = undecodable_;
  told_ = arrivals_.size();
  last_acknowledged_ = now;
  due_.reset();
  return to_packet(out);
}

}  // namespace foresight
