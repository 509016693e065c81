#include "link/recording/played_time.hpp"

#include <algorithm>

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kMost = 100'000'000'000'000'000;  // ns, three years: differences beyond are nonsense
constexpr Duration kJump = 60s;                          // of a clock that was set; lines stand still for less
constexpr std::int64_t kSameOffset = 5'000'000;          // ns: less is how clocks are set right all the time

/// Without overflow.
std::int64_t difference(std::int64_t from, std::int64_t to) {
  const auto out = static_cast<std::int64_t>(static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from));
  return std::clamp(out, -kMost, kMost);
}

std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

}  // namespace

PlayedTime::PlayedTime(RobotTime start, std::int64_t start_unix_ns, double rate)
    : start_(start), anchor_(start), last_due_(start), start_unix_ns_(start_unix_ns), rate_(rate) {}

Duration PlayedTime::stretched(std::int64_t from_ns, std::int64_t to_ns) const {
  const std::int64_t ns = difference(from_ns, to_ns);
  if (rate_ == 1) return Duration{ns};
  constexpr auto most = static_cast<double>(kMost);
  return Duration{std::llround(std::clamp(static_cast<double>(ns) / rate_, -most, most))};
}

RobotTime PlayedTime::due(std::int64_t log_ns, std::int64_t publish_ns, bool kept) {
  const auto odd = [&] {
    const std::int64_t written = difference(last_->publish_ns, publish_ns), came = difference(last_->log_ns, log_ns);
    return std::abs(written - came) > kJump.count();
  };
  if (!last_) {
    publish_ns_ = publish_ns;
  } else if (odd()) {
    if (kept) return last_due_;
    anchor_ = last_due_ + std::max(Duration{0}, stretched(last_->log_ns, log_ns));
    publish_ns_ = publish_ns;
  }
  last_ = {log_ns, publish_ns};
  const RobotTime latest = start_ + Duration{10 * kMost};
  return last_due_ = std::min(latest, std::max(last_due_, anchor_ + stretched(publish_ns_, publish_ns)));
}

void PlayedTime::learn(std::int64_t unix_ns, std::int64_t monotonic_ns, bool exact) {
  if (exact_ && !exact) return;
  const std::int64_t offset = sum(unix_ns, sum(~monotonic_ns, 1));  // unix minus monotonic
  const bool other = !unix_minus_monotonic_ || std::abs(difference(*unix_minus_monotonic_, offset)) > kSameOffset;
  if (other || (exact && !exact_)) unix_minus_monotonic_ = offset;
  exact_ |= exact;
}

std::int64_t PlayedTime::unix_ns(std::int64_t recorded_unix_ns) const {
  const Duration since_start = (anchor_ - start_) + stretched(publish_ns_, recorded_unix_ns);
  return sum(start_unix_ns_, since_start.count());
}

std::int64_t PlayedTime::monotonic_ns(std::int64_t recorded_ns) const {
  if (!unix_minus_monotonic_) return recorded_ns;
  return sum(anchor_.ns, stretched(publish_ns_, sum(recorded_ns, *unix_minus_monotonic_)).count());
}

}  // namespace foresight::link
