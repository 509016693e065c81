#include "link/send_control/transmissions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight {
namespace {

constexpr std::size_t kMostRecords = 20'000;
constexpr Duration kFirstTrip = std::chrono::milliseconds(300);  // until one was measured
constexpr Duration kLeastOvertaking = std::chrono::milliseconds(5), kMostOvertaking = std::chrono::milliseconds(60);
constexpr Duration kFirstQuestion = std::chrono::seconds(1);  // at the latest
// Where losses come in rows of packets, a row is as long as its packets are apart, and holds up pictures for as long. A
// question is 60 bytes with its headers: 8 kbit/s.
constexpr Duration kNextQuestion = std::chrono::milliseconds(60);
constexpr Duration kNewsEvery = std::chrono::milliseconds(10);  // acknowledgements, at most, while packets come
constexpr double kLossMemory = 1e-3;
constexpr Duration kArrivalWrap = std::chrono::microseconds(10) * (std::int64_t{1} << 32);

}  // namespace

std::uint32_t Transmissions::send(std::uint32_t pair, std::uint16_t index, std::size_t bytes, RobotTime now) {
  if (on_the_way_ == 0) last_news_ = now;
  records_.push_back({{next_, pair, index, bytes, now}});
  unacknowledged_ += bytes;
  ++on_the_way_;
  last_send_ = now;
  if (pair == 0) asked_ = true;
  if (records_.size() > kMostRecords) {
    if (records_.front().state == Record::State::on_the_way) {
      unacknowledged_ -= records_.front().sent.bytes;
      --on_the_way_;
    }
    records_.pop_front();
  }
  return next_++;
}

Transmissions::Record* Transmissions::find(std::uint32_t sequence) {
  if (records_.empty() || sequence < records_.front().sent.sequence) return nullptr;
  const std::size_t index = sequence - records_.front().sent.sequence;
  return index < records_.size() ? &records_[index] : nullptr;
}

void Transmissions::take(Record& record, RobotTime now, std::vector<Sent>& out) {
  if (record.state == Record::State::acknowledged) return;
  if (record.state == Record::State::on_the_way) {
    unacknowledged_ -= record.sent.bytes;
    --on_the_way_;
    loss_ *= 1 - kLossMemory;
  } else {
    // It was only overtaken: wait longer from now on, and forget the loss.
    overtaking_ = std::min(2 * overtaking_, kMostOvertaking);
    loss_ = std::max(0.0, loss_ - kLossMemory);
  }
  record.state = Record::State::acknowledged;
  if (record.sent.sequence > newest_) {
    newest_ = record.sent.sequence;
    newest_trip_ = now - record.sent.at;
  }
  recent_.push_back({now, record.sent.bytes});
  out.push_back(record.sent);
}

std::vector<Transmissions::Sent> Transmissions::acknowledge(const Acknowledgement& acknowledgement, RobotTime now) {
  std::vector<Sent> out;
  if (acknowledgement.newest == 0 || acknowledgement.newest >= next_) return out;  // of another session
  measure_round_trip(acknowledgement, now);
  measure_rate(acknowledgement);
  if (Record* record = find(acknowledgement.newest)) take(*record, now, out);
  for (std::size_t i = 0; i < Acknowledgement::kBefore && i + 1 < acknowledgement.newest; ++i)
    if (acknowledgement.before[i])
      if (Record* record = find(acknowledgement.newest - 1 - static_cast<std::uint32_t>(i))) take(*record, now, out);
  if (!out.empty()) {
    asked_ = false;
    last_news_ = now;
    overtaking_ = std::max(kLeastOvertaking, overtaking_ - overtaking_ / 512);
  }
  while (!recent_.empty() && now - recent_.front().at > of_late()) recent_.pop_front();
  // What came may be asked for by copies of this acknowledgement for a while; what is older is settled.
  while (records_.size() > 2 * Acknowledgement::kBefore && records_.front().state != Record::State::on_the_way)
    records_.pop_front();
  return out;
}

void Transmissions::measure_round_trip(const Acknowledgement& acknowledgement, RobotTime now) {
  const Record* record = find(acknowledgement.newest);
  if (!record || record->state == Record::State::acknowledged) return;
  const Duration trip = now - record->sent.at;
  least_ = least_ ? std::min(*least_ + *least_ / 4096, trip) : trip;  // forgets, as routes change
  if (now - second_since_ > std::chrono::seconds(1)) {
    least_of_[1] = std::exchange(least_of_[0], std::nullopt);
    second_since_ = now;
  }
  least_of_[0] = std::min(least_of_[0].value_or(trip), trip);
  variation_ = smooth_ ? (3 * variation_ + Duration(std::abs((trip - *smooth_).count()))) / 4 : trip / 2;
  tripped_at_ = now;
  if (!queued_at_ || trip > *least_ + kNoQueue) queued_at_ = now;
  smooth_ = smooth_ ? (7 * *smooth_ + trip) / 8 : trip;
}

void Transmissions::measure_rate(const Acknowledgement& acknowledgement) {
  for (const Acknowledgement::Arrival& arrival : acknowledgement.arrivals) {
    Record* record = find(arrival.sequence);
    if (!record || record->state == Record::State::acknowledged) continue;
    Duration at = arrival.at;  // of a clock whose 32 bits begin again every 12 hours
    if (last_arrival_) at += kArrivalWrap * std::llround(to_seconds(*last_arrival_ - at) / to_seconds(kArrivalWrap));
    last_arrival_ = at;
    // Where the line carries more, the road is longer if all of late took longer.
    if (rate_.add(record->sent.at, at, record->sent.bytes) && least_of_[0])
      least_ = std::min(*least_of_[0], least_of_[1].value_or(*least_of_[0]));
  }
}

std::optional<RobotTime> Transmissions::loss_deadline(const Record& record) const {
  if (record.state != Record::State::on_the_way || record.sent.sequence > newest_) return std::nullopt;
  return record.sent.at + newest_trip_ + overtaking_;
}

std::vector<Transmissions::Sent> Transmissions::lost(RobotTime now) {
  std::vector<Sent> out;
  for (Record& record : records_) {
    if (record.sent.sequence > newest_) break;
    const std::optional<RobotTime> deadline = loss_deadline(record);
    if (!deadline || *deadline > now) continue;
    record.state = Record::State::lost;
    unacknowledged_ -= record.sent.bytes;
    --on_the_way_;
    loss_ += kLossMemory * (1 - loss_);
    last_loss_ = now;
    out.push_back(record.sent);
  }
  return out;
}

std::optional<RobotTime> Transmissions::question_time() const {
  if (on_the_way_ == 0) return std::nullopt;
  const Duration usual = smooth_ ? *smooth_ + std::max(4 * variation_, kNextQuestion / 2) : kFirstTrip;
  return std::max(last_send_, last_news_) + (asked_ ? kNextQuestion : std::clamp(usual, kNextQuestion, kFirstQuestion));
}

bool Transmissions::question_due(RobotTime now) const {
  const std::optional<RobotTime> time = question_time();
  return time && *time <= now;
}

std::optional<RobotTime> Transmissions::due() const {
  std::optional<RobotTime> first = question_time();
  for (const Record& record : records_) {
    if (record.sent.sequence > newest_) break;
    const std::optional<RobotTime> deadline = loss_deadline(record);
    if (deadline && (!first || *deadline < *first)) first = deadline;
  }
  return first;
}

/// For how long the oldest packet on its way, or any after the last news, should have been told about.
Duration Transmissions::overdue(RobotTime now) const {
  if (on_the_way_ == 0 || !least_) return {};
  const auto oldest = std::find_if(records_.begin(), records_.end(),
                                   [](const Record& record) { return record.state == Record::State::on_the_way; });
  const RobotTime expected = std::max(oldest->sent.at + *least_, last_news_) + kNewsEvery;
  return now > expected ? now - expected : Duration{};
}

std::size_t Transmissions::acknowledged_within(Duration time, RobotTime now) const {
  std::size_t bytes = 0;
  for (const Recent& recent : recent_)
    if (now - recent.at <= time) bytes += recent.bytes;
  return bytes;
}

}  // namespace foresight
