#include "link/send_control/rate_meter.hpp"

#include <algorithm>
#include <utility>

namespace foresight {
namespace {

constexpr Duration kWindow = std::chrono::milliseconds(250);
constexpr Duration kLately = std::chrono::milliseconds(80);
constexpr Duration kLongest = kWindow;                     // of one stretch: after a gap, what comes counts again
constexpr Duration kSlack = std::chrono::milliseconds(2);  // chances of a line come in milliseconds
constexpr Duration kLeastFor = std::chrono::seconds(30);
constexpr Duration kSecond = std::chrono::seconds(1);
constexpr double kSeveralTimes = 4;           // what it was given, the line could have carried
constexpr std::size_t kEnoughBehind = 6'000;  // bytes a second that tell so

}  // namespace

Duration RateMeter::least_way() const {
  return least_[1] ? std::min(*least_[0], *least_[1]) : *least_[0];
}

bool RateMeter::end_second(RobotTime now) {
  const Second over = std::exchange(second_, {.begin = now});
  const double behind_s = std::max(1e-3, to_seconds(over.behind)), passed_s = to_seconds(now - over.begin);
  if (over.bytes_behind < kEnoughBehind || !over.least_way ||
      static_cast<double>(over.bytes_behind) * passed_s < kSeveralTimes * static_cast<double>(over.bytes) * behind_s)
    return false;
  least_[0] = over.least_way;
  least_[1].reset();
  least_since_ = now;
  return true;
}

bool RateMeter::add(RobotTime sent, Duration arrived, std::size_t bytes) {
  const Duration since{sent.ns};
  const bool carries_more = sent - second_.begin > kSecond && end_second(sent);
  if (sent - least_since_ > kLeastFor) {
    least_[1] = least_[0];
    least_[0].reset();
    least_since_ = sent;
  }
  least_[0] = least_[0] ? std::min(*least_[0], arrived - since) : arrived - since;
  second_.bytes += bytes;
  second_.least_way = second_.least_way ? std::min(*second_.least_way, arrived - since) : arrived - since;
  if (last_ && arrived < *last_) return carries_more;
  if (last_ && sent == last_sent_) {
    second_.bytes_behind += bytes;
    second_.behind += arrived - *last_;
  }
  if (last_ && since + least_way() <= *last_ + kSlack) {
    busy_.push_back({std::min(arrived - *last_, kLongest), bytes});
    busy_time_ += busy_.back().lasted;
    busy_bytes_ += bytes;
    while (busy_.size() > 1 && busy_time_ - busy_.front().lasted > kWindow) {
      busy_time_ -= busy_.front().lasted;
      busy_bytes_ -= busy_.front().bytes;
      busy_.pop_front();
    }
  }
  last_ = arrived;
  last_sent_ = sent;
  return carries_more;
}

std::optional<double> RateMeter::rate(Duration overdue) const {
  if (busy_bytes_ == 0) return std::nullopt;
  const auto rate_of = [](std::size_t bytes, Duration time) {
    return static_cast<double>(bytes) / std::max(1e-3, to_seconds(time));
  };
  Duration lately = overdue;
  std::size_t bytes = 0;
  for (auto stretch = busy_.rbegin(); stretch != busy_.rend() && (bytes == 0 || lately < kLately); ++stretch) {
    lately += stretch->lasted;
    bytes += stretch->bytes;
  }
  return std::min(rate_of(busy_bytes_, busy_time_ + overdue), rate_of(bytes, lately));
}

}  // namespace foresight
