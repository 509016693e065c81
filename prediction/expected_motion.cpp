#include "prediction/expected_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight {
namespace {

constexpr double kSetPointsPerSecond = 200;
constexpr double kOvertakingOver = 4, kMostOvertaken = 0.1;  // s
constexpr double kMostAtOnce = 0.03;                         // s
constexpr double kGap = 0.2;                                 // s: that late the line stands still, which is no jitter
constexpr double kLateOver = 0.2, kMostLate = 0.05;          // s
constexpr double kMoves = 0.02;                              // rad/s or m/s, of all joints: slower tells no time
constexpr double kBlind = 0.3;                               // s without agreement: what went on meanwhile is not known
constexpr double kNewStart = 0.05;  // rad or m: set-points that jump so far began anew where the robot stands

/// By how much later than expected the robot's set-points came to where it tells they were, s; 0 where they hardly
/// move.
double lateness(const RobotReport& report, const GateModel::State& expected) {
  double ways = 0, squares = 0;
  for (std::size_t i = 0; i < report.joints; ++i) {
    const auto& told = report.joint[i].set_point;
    ways += told.velocity * (expected.motion[i].position - told.position);
    squares += told.velocity * told.velocity;
  }
  return squares > kMoves * kMoves ? std::clamp(ways / squares, -kMostAtOnce, kMostAtOnce) : 0;
}

/// What the robot's end of a line asks for, and since when that is known.
struct Permit {
  std::uint64_t consent = 0;
  bool released = false;
  RobotTime consent_at, released_at;
};

/// As it told, or as is expected since: that the switch was opened meanwhile makes no consent an old one. Who follows
/// has consent, whatever was expected.
std::optional<Permit> permit_of(const RobotReport& report, const GateModel::State* expected) {
  if (!report.permit) return std::nullopt;
  const RobotTime told = report.permit->time;
  Permit out{report.permit->consent, report.permit->let_go, told, told};
  if (expected == nullptr || !expected->consent || report.doing == GateDoing::following) return out;
  if (told < expected->consent_at) {
    out.consent = *expected->consent;
    out.consent_at = expected->consent_at;
  }
  if (told < expected->released_at) {
    out.released = expected->released;
    out.released_at = expected->released_at;
  }
  return out;
}

bool agrees(const RobotReport& report, const GateModel::State& expected) {
  if (expected.doing != report.doing) return false;
  const std::optional<Permit> permit = permit_of(report, &expected);
  return !permit || (expected.consent == permit->consent &&
                     (report.doing == GateDoing::following || expected.released == permit->released));
}

}  // namespace

ExpectedMotion::ExpectedMotion(GateOptions gate, RobotShape* shape, const ExpectedMotionOptions& options)
    : options_(options),
      gate_(std::move(gate), shape),
      period_(seconds(1 / gate_.options().rate_hz)),
      sent_(static_cast<std::size_t>(options.keeps * kSetPointsPerSecond)),
      cycles_(static_cast<std::size_t>(options.keeps * gate_.options().rate_hz)),
      line_(options.line),
      gaps_(options.longest_gap) {}

void ExpectedMotion::sent(const SentSetPoint& set_point) noexcept {
  const std::size_t before = sent_.size();
  sent_.next() = set_point;
  if (sent_.size() == before && next_ > 0) --next_;  // the oldest one went
}

std::size_t ExpectedMotion::first_after(std::uint64_t number) const noexcept {
  std::size_t from = 0, to = sent_.size();
  while (from < to) {
    const std::size_t middle = (from + to) / 2;
    if (sent_[middle].number <= number)
      from = middle + 1;
    else
      to = middle;
  }
  return from;
}

const SentSetPoint* ExpectedMotion::find(std::uint64_t number) const noexcept {
  const std::size_t after = first_after(number);
  return after > 0 && sent_[after - 1].number == number ? &sent_[after - 1] : nullptr;
}

const GateModel::State* ExpectedMotion::cycle_at(RobotTime time) const noexcept {
  if (cycles_.empty()) return nullptr;
  const Duration after_first = time - cycles_[0].time;
  const auto index = static_cast<std::int64_t>(std::llround(to_seconds(after_first) / to_seconds(period_)));
  // Cycles are a period apart, but for where they were made anew.
  for (std::int64_t i = std::max<std::int64_t>(0, index - 2); i <= index + 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (at < cycles_.size() && std::abs((cycles_[at].time - time).count()) <= period_.count() / 2) return &cycles_[at];
  }
  return nullptr;
}

// Of those that take as long as expected.
const SentSetPoint* ExpectedMotion::newest_at(RobotTime time) const noexcept {
  for (std::size_t i = sent_.size(); i > 0; --i)
    if (sent_[i - 1].sent + acts_after_ <= time) return &sent_[i - 1];
  return nullptr;
}

// Where set-points overtake each other and get lost, the newest one that came is not as old as one that takes the usual
// delay: it depends on line and rate alike, and is learnt as it is. On a line without jitter it is 0.
void ExpectedMotion::learn_overtaking(const RobotReport& report) noexcept {
  const SentSetPoint *newest = find(report.newest_set_point), *expected = newest_at(report.time + seconds(late_));
  if (newest == nullptr || expected == nullptr || reported_.ns == 0) return;
  const double late = to_seconds(expected->sent - newest->sent);
  if (std::abs(late) > kGap) return;
  const double share = 1 - std::exp(-to_seconds(report.time - reported_) / kOvertakingOver);
  overtaken_ += share * std::clamp(late, -kMostAtOnce, kMostAtOnce);
  overtaken_ = std::clamp(overtaken_, -kMostOvertaken, kMostOvertaken);
}

// What came waits until the robot's program looks for it, and for the gate's next cycle. Cycles that were just made
// anew show little of it, so it is summed up until nothing is left.
void ExpectedMotion::learn_lateness(const RobotReport& report) noexcept {
  const GateModel::State* expected = cycle_at(report.time);
  if (expected == nullptr || reported_.ns == 0) return;
  if (report.doing != GateDoing::following || expected->doing != GateDoing::following) return;
  const double share = 1 - std::exp(-to_seconds(report.time - reported_) / kLateOver);
  late_ = std::clamp(late_ + share * lateness(report, *expected), 0.0, kMostLate);
}

// For how long no set-point had come by the report, although some should have.
double ExpectedMotion::missing(const RobotReport& report) const noexcept {
  const std::size_t next = first_after(report.newest_set_point);
  if (find(report.newest_set_point) == nullptr || next == sent_.size() || !line_delay_.valid) return 0;
  const double late = to_seconds(report.time - sent_[next].sent) - line_delay_.seconds;
  return std::clamp(late, 0.0, std::max(0.0, to_seconds(report.time - report.newest_came)));
}

// What keeps set-points away from the robot keeps all of them away, and it stops once the newest one lasts no more.
void ExpectedMotion::learn_gaps(const RobotReport& report) noexcept {
  if (report.newest_set_point != gap_after_) gaps_.add(std::exchange(gap_, 0), to_seconds(report.time - epoch_));
  gap_after_ = report.newest_set_point;
  gap_ = missing(report);
  stop_chance_ = 0;
  if (gap_ < LineGaps::kNotable || report.doing != GateDoing::following) return;
  const SentSetPoint& newest = *find(gap_after_);
  const double began = to_seconds(report.time - newest.sent) - gap_;
  stop_chance_ = gaps_.chance_to_reach(to_seconds(newest.lasts) - began, gap_);
}

void ExpectedMotion::learn_delay(const RobotReport& report, RobotTime now) noexcept {
  const SentSetPoint* newest = report.newest_set_point > newest_told_ ? find(report.newest_set_point) : nullptr;
  if (newest != nullptr) {
    newest_told_ = report.newest_set_point;
    const double came = to_seconds(report.newest_came - epoch_);
    if (line_.add(came, to_seconds(report.newest_came - newest->sent))) line_delay_ = line_.at(came);
  }
  learn_overtaking(report);
  learn_lateness(report);
  learn_gaps(report);
  delay_ = line_delay_;
  delay_.seconds = std::max(0.0, delay_.seconds + overtaken_ + late_);
  // Until the robot tells: as long as the way back.
  if (!delay_.valid) delay_ = {std::max(0.0, to_seconds(now - report.time)), 0.02, newest_told_ != 0};
}

double ExpectedMotion::deviation(const RobotReport& report, const GateModel::State& expected) const noexcept {
  double out = 0;
  for (std::size_t i = 0; i < report.joints; ++i)
    out = std::max(out, std::abs(report.joint[i].set_point.position - expected.motion[i].position));
  return out;
}

GateModel::State ExpectedMotion::state_of(const RobotReport& report, const GateModel::State* expected) const noexcept {
  const GateOptions& options = gate_.options();
  GateModel::State out;
  out.time = report.time;
  out.doing = report.doing;
  for (std::size_t i = 0; i < report.joints; ++i) {
    out.motion[i] = report.joint[i].set_point;
    if (!std::isfinite(out.motion[i].acceleration))
      out.motion[i].acceleration = expected != nullptr ? expected->motion[i].acceleration : 0;
    out.target[i] = out.motion[i].position;
  }
  const double share = (report.speed - GateOptions::kFirstSpeed) / (1 - GateOptions::kFirstSpeed);
  out.engaged = report.time - seconds(std::clamp(share, 0.0, 1.0) * options.ramp_s);
  constexpr double kSameSpeed = 1e-3;
  if (expected != nullptr && expected->doing == report.doing &&
      std::abs(options.speed_after(report.time - expected->engaged) - report.speed) < kSameSpeed)
    out.engaged = expected->engaged;
  const SentSetPoint* newest = nullptr;
  if (report.newest_set_point != 0) {
    out.taken = report.newest_set_point;
    newest = find(out.taken);
  } else {
    newest = newest_at(report.time);
    out.taken = newest != nullptr ? newest->number : 0;
  }
  const bool in_time =
      newest != nullptr && (report.newest_set_point == 0 || report.newest_came <= newest->sent + newest->lasts);
  if (in_time) {
    out.newest = newest->deadman ? SetPointKind::pressed : SetPointKind::open;
    out.target = newest->position;
    out.expires = newest->sent + newest->lasts;
    out.agreed = newest->consent;
  }
  out.released =
      expected != nullptr && expected->doing == report.doing ? expected->released : in_time && !newest->deadman;
  if (const std::optional<Permit> permit = permit_of(report, expected)) {
    // It asks for another consent since the last set-point expired: that is no loss to come.
    if (report.doing != GateDoing::following && permit->consent_at > out.expires) out.newest = SetPointKind::none;
    out.consent = permit->consent;
    out.consent_at = permit->consent_at;
    out.released_at = permit->released_at;
    if (report.doing != GateDoing::following) out.released = permit->released;
  }
  return out;
}

// What was expected since the last report that agreed is bent to where this one says the set-points were.
void ExpectedMotion::correct_past(const RobotReport& report) noexcept {
  const GateModel::State* expected = cycle_at(report.time);
  if (expected == nullptr || report.time <= confirmed_) return;
  GuardedMotion::Motions off{};
  for (std::size_t i = 0; i < report.joints; ++i)
    off[i].position = report.joint[i].set_point.position - expected->motion[i].position;
  const double span = to_seconds(report.time - confirmed_);
  for (std::size_t k = cycles_.size(); k > 0 && cycles_[k - 1].time > confirmed_; --k) {
    GateModel::State& cycle = cycles_[k - 1];
    const double share = std::min(1.0, to_seconds(cycle.time - confirmed_) / span);
    for (std::size_t i = 0; i < report.joints; ++i) cycle.motion[i].position += share * off[i].position;
  }
}

void ExpectedMotion::begin_anew(const RobotReport& report, bool restarted) noexcept {
  const GateModel::State state = state_of(report, cycle_at(report.time));
  if (restarted)
    cycles_.clear();
  else
    correct_past(report);
  while (!cycles_.empty() && cycles_.newest().time > report.time - period_ / 2) cycles_.drop_newest();
  gate_.set(state);
  cycles_.next() = state;
  next_ = first_after(state.taken);
  acts_after_ = seconds(delay_.seconds);
  held_until_ = report.time + seconds(gap_ < LineGaps::kNotable ? 0 : gaps_.expected_length(gap_) - gap_);
}

std::optional<ExpectedMotion::Change> ExpectedMotion::reported(const RobotReport& report, RobotTime now) noexcept {
  if (epoch_.ns == 0) epoch_ = report.time;
  learn_delay(report, now);
  reported_ = report.time;
  follows_others_ =
      report.doing == GateDoing::following && report.newest_set_point != 0 && find(report.newest_set_point) == nullptr;
  const GateModel::State* expected = cycle_at(report.time);
  const bool other_line = std::abs(delay_.seconds - to_seconds(acts_after_)) > options_.sooner;
  const bool as_expected = expected != nullptr && agrees(report, *expected);
  const bool held_longer = gap_ >= LineGaps::kNotable && held_until_ <= report.time;
  if (as_expected && !other_line && !held_longer && deviation(report, *expected) <= options_.tolerance) {
    confirmed_ = report.time;
    return {};
  }
  const bool urgent = expected == nullptr || expected->doing != report.doing;
  if (!urgent && now - made_anew_ < seconds(options_.anew_every)) return {};
  made_anew_ = now;
  const bool moves =
      expected != nullptr && (report.doing == GateDoing::following || expected->doing == GateDoing::following);
  const bool blind = moves && report.time - confirmed_ > seconds(kBlind);
  const bool restarted = expected == nullptr || ((!moves || blind) && deviation(report, *expected) > kNewStart);
  const RobotTime after = restarted ? report.time - period_ : std::min(confirmed_, report.time);
  begin_anew(report, restarted);
  confirmed_ = report.time;
  return Change{after, restarted};
}

void ExpectedMotion::cycle() noexcept {
  const RobotTime time = gate_.state().time + period_;
  for (; next_ < sent_.size() && std::max(sent_[next_].sent + acts_after_, held_until_) <= time; ++next_)
    gate_.take(sent_[next_], time);
  gate_.cycle(time);
  cycles_.next() = gate_.state();
}

void ExpectedMotion::advance(RobotTime now) noexcept {
  if (cycles_.empty()) return;
  known_until_ = std::min(now + acts_after_, reported_ + seconds(options_.farthest));
  while (gate_.state().time + period_ < known_until_) cycle();
}

}  // namespace foresight
