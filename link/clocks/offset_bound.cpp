#include "link/clocks/offset_bound.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace foresight {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kMostStamp = std::int64_t{1} << 61;  // 73 years: sums and differences of stamps still fit
constexpr std::int64_t kFarApart = 2 * kMostStamp - 1;      // no bound
constexpr std::int64_t kJump = 10'000'000;                  // by which bounds miss each other, ns
constexpr std::int64_t kShift = 10'000'000;                 // of both bounds at once, ns
constexpr std::int64_t kRecent = 2 * kSecond;               // of exchanges that are compared with those before
constexpr std::int64_t kAnchorBlock = 4;                    // seconds
constexpr DriftInterval kAnyDrift{-OffsetBound::kMostDrift, OffsetBound::kMostDrift};

bool plausible(std::int64_t stamp) {
  return stamp >= 0 && stamp < kMostStamp;
}

std::int64_t drifted(double drift, std::int64_t time) {
  return static_cast<std::int64_t>(std::ceil(drift * static_cast<double>(time)));
}

/// How much the offset may have grown from some instant between `from` and `to` until `here`.
std::int64_t most_growth(const DriftInterval& drift, std::int64_t from, std::int64_t to, std::int64_t here) {
  return std::max({drifted(drift.most, here - from), drifted(drift.least, here - from), drifted(drift.most, here - to),
                   drifted(drift.least, here - to)});
}

}  // namespace

std::int64_t OffsetBound::upper_at(std::int64_t here, const DriftInterval& drift, std::int64_t older_than) const {
  std::int64_t out = kFarApart;
  for (std::size_t i = 0; i < count_; ++i) {
    const Bound& b = buckets_[i].upper;
    if (b.to < older_than) out = std::min(out, b.offset + most_growth(drift, b.from, b.to, here));
  }
  return out;
}

std::int64_t OffsetBound::lower_at(std::int64_t here, const DriftInterval& drift, std::int64_t older_than) const {
  std::int64_t out = -kFarApart;
  const DriftInterval back{-drift.most, -drift.least};
  for (std::size_t i = 0; i < count_; ++i) {
    const Bound& b = buckets_[i].lower;
    if (b.to < older_than) out = std::max(out, b.offset - most_growth(back, b.from, b.to, here));
  }
  return out;
}

std::optional<OffsetInterval> OffsetBound::at(std::int64_t here) const {
  if (count_ == 0 || !plausible(here)) return std::nullopt;
  OffsetInterval out{lower_at(here, drift_, INT64_MAX), upper_at(here, drift_, INT64_MAX)};
  // What was learned of the drift is likely, not certain.
  if (out.least > out.most) out = {lower_at(here, kAnyDrift, INT64_MAX), upper_at(here, kAnyDrift, INT64_MAX)};
  if (out.least > out.most) std::swap(out.least, out.most);
  return out;
}

std::optional<OffsetInterval> OffsetBound::at_there(std::int64_t there) const {
  if (count_ == 0 || !plausible(there)) return std::nullopt;
  // The offset changes so slowly that one step finds the instant; what it is off by costs a ten-thousandth of it.
  const auto instant = [there](std::int64_t offset) {
    return std::clamp<std::int64_t>(there - offset, 0, kMostStamp - 1);
  };
  const auto first = at(instant(buckets_[newest_].upper.offset));
  return at(instant(first->middle()));
}

ClockNews OffsetBound::judge(const Bound& upper, const Bound& lower) const {
  std::int64_t apart = lower.offset - upper.offset;
  if (count_ > 0) {
    const auto least = std::min(lower_at(upper.from, kAnyDrift, INT64_MAX), lower_at(upper.to, kAnyDrift, INT64_MAX));
    const auto most = std::max(upper_at(lower.from, kAnyDrift, INT64_MAX), upper_at(lower.to, kAnyDrift, INT64_MAX));
    apart = std::max({apart, least - upper.offset, lower.offset - most});
  }
  if (apart > kJump) return ClockNews::jumped;
  return apart > 0 ? ClockNews::doubted : ClockNews::fine;
}

/// Both bounds of the last seconds lie beside those before, by the same way. A line that gets slower moves them apart;
/// only a clock that was set by less than the line's delay moves them together.
bool OffsetBound::has_moved(std::int64_t here) const {
  OffsetInterval recent{-kFarApart, kFarApart};
  for (std::size_t i = 0; i < count_; ++i) {
    const Bucket& b = buckets_[i];
    if (b.upper.to >= here - kRecent) recent.most = std::min(recent.most, b.upper.offset);
    if (b.lower.to >= here - kRecent) recent.least = std::max(recent.least, b.lower.offset);
  }
  const OffsetInterval before{lower_at(here, drift_, here - kRecent), upper_at(here, drift_, here - kRecent)};
  if (recent.least == -kFarApart || recent.most == kFarApart || before.least == -kFarApart || before.most == kFarApart)
    return false;
  const std::int64_t least = recent.least - before.least, most = recent.most - before.most;
  const std::int64_t shift = (least + most) / 2;
  return std::abs(shift) > kShift && std::abs(most - least) < std::abs(shift) / 2;
}

void OffsetBound::start_anew(ClockNews why, std::int64_t now) {
  count_ = 0;
  newest_ = 0;
  drift_ = kAnyDrift;
  if (why != ClockNews::jumped) return;
  ++jumps_;
  valid_since_ = now;
}

void OffsetBound::keep(const Bound& upper, const Bound& lower, std::int64_t now) {
  const std::int64_t second = now / kSecond;
  if (count_ > 0 && buckets_[newest_].second >= second) {
    Bucket& b = buckets_[newest_];
    if (upper.offset < b.upper.offset) b.upper = upper;
    if (lower.offset > b.lower.offset) b.lower = lower;
    return;
  }
  newest_ = count_ == 0 ? 0 : (newest_ + 1) % kBuckets;
  count_ = std::min(count_ + 1, kBuckets);
  buckets_[newest_] = {second, upper, lower};
}

ClockNews OffsetBound::add(const Exchange& e) {
  const bool possible = plausible(e.sent) && plausible(e.received) && plausible(e.answered) && plausible(e.returned) &&
                        e.returned >= e.sent && e.answered >= e.received;
  if (!possible) return ClockNews::nonsense;
  if (e.sent < valid_since_) return ClockNews::stale;
  const Bound upper{e.received - e.sent, e.sent, e.returned}, lower{e.answered - e.returned, e.sent, e.returned};
  ClockNews news = judge(upper, lower);
  // What was begun before the jump and ended after it is of neither clock.
  if (news == ClockNews::jumped) {
    start_anew(news, e.returned);
    return news;
  }
  const bool new_second = count_ > 0 && buckets_[newest_].second < e.returned / kSecond;
  if (news == ClockNews::fine && new_second && has_moved(e.returned)) news = ClockNews::doubted;
  if (news == ClockNews::doubted) start_anew(news, e.returned);
  if (new_second) learn_drift();
  keep(upper, lower, e.returned);
  return news;
}

void OffsetBound::learn_drift() {
  std::vector<OffsetAnchor> anchors;
  std::int64_t block = -1;
  for (std::size_t i = 0; i < count_; ++i) {
    const Bucket& b = buckets_[count_ < kBuckets ? i : (newest_ + 1 + i) % kBuckets];
    const auto mean = [](const Bound& x) {
      return 0.5 * static_cast<double>(x.from) + 0.5 * static_cast<double>(x.to);
    };
    const OffsetAnchor anchor{0.5 * (mean(b.upper) + mean(b.lower)), static_cast<double>(b.lower.offset),
                              static_cast<double>(b.upper.offset)};
    if (b.second / kAnchorBlock != block) {
      anchors.push_back(anchor);
      block = b.second / kAnchorBlock;
    } else if (anchor.most - anchor.least < anchors.back().most - anchors.back().least) {
      anchors.back() = anchor;
    }
  }
  drift_ = drift_of(anchors, kAnyDrift);
}

}  // namespace foresight
