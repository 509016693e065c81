#include "link/send_control/rate_meter.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr Duration kWindow = std::chrono::milliseconds(250);
constexpr Duration kLately = std::chrono::milliseconds(80);
constexpr Duration kLongest = kWindow;                     // of one stretch: after a gap, what comes counts again
constexpr Duration kSlack = std::chrono::milliseconds(2);  // chances of a line come in milliseconds
constexpr Duration kLeastFor = std::chrono::seconds(30);

}  // namespace

Duration RateMeter::least_way() const {
  return least_[1] ? std::min(*least_[0], *least_[1]) : *least_[0];
}

void RateMeter::add(RobotTime sent, Duration arrived, std::size_t bytes) {
  const Duration since{sent.ns};
  if (sent - least_since_ > kLeastFor) {
    least_[1] = least_[0];
    least_[0].reset();
    least_since_ = sent;
  }
  least_[0] = least_[0] ? std::min(*least_[0], arrived - since) : arrived - since;
  if (last_ && arrived < *last_) return;
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
