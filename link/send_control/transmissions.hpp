// What was sent, and what became of it: acknowledged, lost, or not known yet.
//
// A packet counts as lost when one that was sent later has come, and it has had the time that the later one took, and a
// little more for packets that overtake each other (the rule of RACK, RFC 8985, by time and not by count). Where
// nothing comes back at all, questions are asked: the first answer tells what is lost, and a line that stands still is
// not filled with copies.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

#include "link/send_control/packets.hpp"
#include "link/send_control/rate_meter.hpp"

namespace foresight {

/// One thread.
class Transmissions {
 public:
  struct Sent {
    std::uint32_t sequence = 0;
    std::uint32_t pair = 0;  ///< 0: a question
    std::uint16_t index = 0;
    std::size_t bytes = 0;  ///< of the packet
    RobotTime at;
  };

  /// Remembers a packet that is sent now; its sequence.
  std::uint32_t send(std::uint32_t pair, std::uint16_t index, std::size_t bytes, RobotTime now);
  /// What an acknowledgement that came at `now` says: the packets that are new in it.
  std::vector<Sent> acknowledge(const Acknowledgement& acknowledgement, RobotTime now);
  /// The packets that count as lost from now on.
  std::vector<Sent> lost(RobotTime now);
  /// Whether a question is due; asked, it is sent like any packet, as of pair 0.
  bool question_due(RobotTime now) const;
  /// When `lost` or `question_due` may have something.
  std::optional<RobotTime> due() const;

  /// Bytes on their way: sent, and neither acknowledged nor lost.
  std::size_t unacknowledged() const { return unacknowledged_; }
  /// Bytes whose acknowledgement came within `time`, which is at most of_late().
  std::size_t acknowledged_within(Duration time, RobotTime now) const;
  static constexpr Duration kRecent = std::chrono::milliseconds(200);
  /// In what a packet and its acknowledgement take on an empty line, as much is acknowledged as the road holds at the
  /// line's rate: of a long road more than that has to be looked at to fill it, of a short one kRecent.
  Duration of_late() const { return std::max(kRecent, least_.value_or(Duration{}) * 3 / 2); }

  bool lost_lately(RobotTime now) const { return last_loss_ && now - *last_loss_ < std::chrono::seconds(10); }
  std::optional<Duration> round_trip() const { return smooth_; }  ///< of late, waiting in the line included
  std::optional<Duration> least_round_trip() const { return least_; }
  /// What the line carries, as far as it can be trusted (RateMeter::rate), with what is overdue at `now`.
  std::optional<double> rate(RobotTime now) const { return rate_.rate(overdue(now)); }
  /// For how long nothing had to wait in the line for more than kNoQueue.
  Duration calm(RobotTime now) const { return queued_at_ ? now - *queued_at_ : Duration{}; }
  /// Likewise, until the last packet that was told of: of a silence nothing is known.
  Duration known_calm() const { return queued_at_ ? tripped_at_ - *queued_at_ : Duration{}; }
  static constexpr Duration kNoQueue = std::chrono::milliseconds(20);
  /// Share of packets that were lost, of about the last thousand.
  double loss() const { return loss_; }

 private:
  struct Record {
    Sent sent;
    enum class State { on_the_way, acknowledged, lost } state = State::on_the_way;
  };
  Record* find(std::uint32_t sequence);
  Duration overdue(RobotTime now) const;
  void take(Record& record, RobotTime now, std::vector<Sent>& out);
  void measure_round_trip(const Acknowledgement& acknowledgement, RobotTime now);
  void measure_rate(const Acknowledgement& acknowledgement);
  std::optional<RobotTime> loss_deadline(const Record& record) const;
  std::optional<RobotTime> question_time() const;

  std::deque<Record> records_;  // by sequence, without a hole
  std::uint32_t next_ = 1;
  std::size_t unacknowledged_ = 0;
  std::size_t on_the_way_ = 0;  // packets
  struct Recent {
    RobotTime at;
    std::size_t bytes;
  };
  std::deque<Recent> recent_;
  RateMeter rate_;
  std::uint32_t measured_ = 0;  // sequence up to which arrivals went into the meter
  std::optional<Duration> last_arrival_;
  std::uint32_t newest_ = 0;  // of those acknowledged, the one sent last
  Duration newest_trip_{};    // and how long it took
  std::optional<Duration> smooth_, least_;
  std::optional<Duration> least_of_[2];  // this second and the one before
  RobotTime second_since_;
  Duration variation_{}, overtaking_ = std::chrono::milliseconds(5);
  std::optional<RobotTime> queued_at_;  // the last trip that took longer than the least and kNoQueue; the first
  RobotTime tripped_at_;                // when the last trip ended
  RobotTime last_send_, last_news_;
  bool asked_ = false;  // since the last news
  std::optional<RobotTime> last_loss_;
  double loss_ = 0;
};

}  // namespace foresight
