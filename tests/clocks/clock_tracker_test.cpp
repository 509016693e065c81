#include "link/clocks/clock_tracker.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_line.hpp"

namespace foresight::clock_tracker_test {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kStep = 1'000'000;  // of true time, ns

/// The clock of a host in true time, ns.
struct HostClock {
  double drift = 0, wander = 0;  // shares; the wander's period is ten minutes
  double phase = 0;
  std::int64_t jumped = 0, start = 0;
  std::int64_t at(std::int64_t true_ns) const {
    const double t = static_cast<double>(true_ns), w = 2 * M_PI / 600e9;
    return start + jumped + true_ns + std::llround(drift * t + wander / w * std::sin(w * t + phase));
  }
};

/// Two hosts that ping each other's clocks; we look through the eyes of the one.
class TwoHosts {
 public:
  TwoHosts(RandomLineOptions there, RandomLineOptions back, HostClock remote, std::uint64_t seed)
      : remote_(remote), there_(there, seed), back_(back, seed + 1'000'000) {}

  /// Goes on by a millisecond.
  void step(bool line_up = true) {
    now_ += kStep;
    const Time<RobotClock> here{local_.at(now_)};
    if (const auto ping = tracker_.ping(here)) there_.send(now_, {*ping, now_});
    for (const Ping& ping : there_.take(now_)) {
      const OperatorTime t{remote_.at(now_)};
      if (line_up) back_.send(now_, {ClockTracker<OperatorClock, RobotClock>::answer(ping.ping, t), ping.sent});
    }
    for (const Pong& pong : back_.take(now_)) {
      last_ = tracker_.pong(pong.pong, here);
      if (last_ == ClockNews::jumped && detected_ == 0) detected_ = now_;
      ++news_[static_cast<std::size_t>(last_)];
      if (last_ == ClockNews::fine) shortest_ = std::min(shortest_, now_ - pong.sent);
    }
  }
  void run(double seconds) {
    for (const std::int64_t until = now_ + std::llround(seconds * 1e9); now_ < until;) step();
  }
  std::int64_t truth() const { return remote_.at(now_) - local_.at(now_); }
  std::optional<OffsetInterval> bound() const { return tracker_.bound().at(local_.at(now_)); }
  bool holds() const {
    const auto b = bound();
    return b && b->least <= truth() && truth() <= b->most;
  }
  /// Half of the smallest round trip and a millisecond.
  bool tight() const { return bound()->half() <= shortest_ / 2 + 1'000'000; }

  struct Ping {
    ClockPing ping;
    std::int64_t sent = 0;
  };
  struct Pong {
    ClockPong pong;
    std::int64_t sent = 0;
  };
  std::int64_t now_ = 0, shortest_ = INT64_MAX, detected_ = 0;
  std::array<int, 5> news_{};
  ClockNews last_{};
  HostClock local_{.start = 5'000'000'000}, remote_;
  RandomLine<Ping> there_;
  RandomLine<Pong> back_;
  ClockTracker<RobotClock, OperatorClock> tracker_{77};
};

double uniform(std::mt19937_64& random, double a, double b) {
  return std::uniform_real_distribution(a, b)(random);
}

/// From a cable to a bad mobile uplink.
RandomLineOptions any_line(std::mt19937_64& random) {
  RandomLineOptions out;
  out.base_s = 1e-4 * std::pow(10, uniform(random, 0, 3.3));  // 0.1 to 200 ms
  out.jitter_s = out.base_s * uniform(random, 0, 0.5);
  out.congested_share = uniform(random, 0, 0.3);
  out.congestion_s = uniform(random, 0, 0.5);
  out.loss = uniform(random, 0, 0.2);
  out.burst_share = uniform(random, 0, 0.1);
  out.outage_share = uniform(random, 0, 1) < 0.5 ? 0 : uniform(random, 0, 0.15);
  out.duplicated = uniform(random, 0, 0.1);
  out.late = uniform(random, 0, 0.1);
  out.in_order = uniform(random, 0, 1) < 0.5;
  return out;
}

HostClock any_clock(std::mt19937_64& random) {
  return {uniform(random, -50e-6, 50e-6), uniform(random, 0, 1e-6), uniform(random, 0, 6), 0,
          std::llround(uniform(random, 0, 1e18))};
}

TEST(ClockTrackerTest, TheTruthIsInsideOfTheBoundAndTheBoundIsTight) {
  int right = 0, tight = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    const auto there = any_line(random), back = any_line(random);
    TwoHosts hosts(there, back, any_clock(random), seed);
    hosts.run(10);
    bool held = true, was_tight = true;
    for (int second = 10; second < 90; ++second) {
      hosts.run(1);
      held = held && hosts.holds();
      was_tight = was_tight && hosts.tight();
    }
    right += held;
    tight += held && was_tight;
  }
  RecordProperty("right", right);
  RecordProperty("tight", tight);
  EXPECT_GE(right, 190);
  EXPECT_GE(tight, 190);
}

// Routes that get slower and faster by up to twice, each direction on its own.
TEST(ClockTrackerTest, TheTruthStaysInsideWhereTheRouteChanges) {
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    auto there = any_line(random), back = any_line(random);
    for (RandomLineOptions* line : {&there, &back}) {
      line->step_every_s = 15;
      line->step_s = line->base_s;
    }
    TwoHosts hosts(there, back, any_clock(random), seed);
    hosts.run(10);
    bool held = true;
    for (int second = 10; second < 90; ++second) {
      hosts.run(1);
      held = held && hosts.holds();
    }
    right += held;
  }
  RecordProperty("right", right);
  EXPECT_GE(right, 190);
}

TEST(ClockTrackerTest, ADriftIsFollowedAndKnownThroughALongOutage) {
  for (const double drift : {50e-6, -50e-6}) {
    RandomLineOptions line{.base_s = 0.01, .jitter_s = 0.002};
    TwoHosts hosts(line, line, {.drift = drift, .wander = 1e-6}, 3);
    for (int second = 0; second < 300; ++second) {
      hosts.run(1);
      ASSERT_TRUE(hosts.holds()) << second;
    }
    const DriftInterval learned = hosts.tracker_.bound().drift();
    EXPECT_LE(learned.least, drift);
    EXPECT_GE(learned.most, drift);
    EXPECT_LT(learned.most - learned.least, 30e-6);
    // As long as the longest gap of the recorded lines.
    for (const std::int64_t until = hosts.now_ + 78'000'000'000; hosts.now_ < until;) hosts.step(false);
    EXPECT_TRUE(hosts.holds());
    EXPECT_LT(hosts.bound()->half(), hosts.shortest_ / 2 + 2'000'000);
  }
}

TEST(ClockTrackerTest, AJumpOfASecondIsNoticedWithinTwoSecondsOfALineThatIsUp) {
  int noticed = 0, held = 0;
  const int lines = 200;
  for (std::uint64_t seed = 1; seed <= lines; ++seed) {
    std::mt19937_64 random(seed);
    auto there = any_line(random), back = any_line(random);
    there.congestion_s = back.congestion_s = 0.2;
    TwoHosts hosts(there, back, any_clock(random), seed);
    hosts.run(20);
    EXPECT_EQ(hosts.news_[static_cast<std::size_t>(ClockNews::jumped)], 0) << seed << ": there was none";
    // Either clock, in either direction.
    (seed % 2 == 0 ? hosts.local_ : hosts.remote_).jumped += (seed % 4 < 2 ? 1 : -1) * 1'000'000'000;
    for (int up = 0; up < 2000 && hosts.detected_ == 0;) {
      hosts.step();
      up += hosts.there_.up(hosts.now_) && hosts.back_.up(hosts.now_);
    }
    noticed += hosts.detected_ != 0;
    hosts.run(5);
    bool inside = true;
    for (int second = 0; second < 20; ++second) {
      hosts.run(1);
      inside = inside && hosts.holds();
    }
    held += inside && hosts.tracker_.bound().jumps() == 1;
  }
  RecordProperty("noticed", noticed);
  EXPECT_GE(noticed, lines * 95 / 100);
  EXPECT_GE(held, lines * 95 / 100);
}

// Shorter than the round trip: it could be the line's doing, but not in both directions at once.
TEST(ClockTrackerTest, ASmallJumpIsDoubtedAndTheBoundIsRightAgain) {
  RandomLineOptions line{.base_s = 0.08, .jitter_s = 0.004};
  for (const std::int64_t jump : {100, -100, 40, -40}) {
    TwoHosts hosts(line, line, {}, 5);
    hosts.run(20);
    hosts.remote_.jumped = jump * 1'000'000;
    hosts.run(4);
    EXPECT_TRUE(hosts.holds()) << jump;
    EXPECT_EQ(hosts.tracker_.bound().jumps(), 0u);
  }
}

TEST(ClockTrackerTest, ASuspendedHostIsNoticed) {
  for (const bool local : {true, false}) {
    TwoHosts hosts({.base_s = 0.02}, {.base_s = 0.02}, {}, 6);
    hosts.run(10);
    hosts.now_ += 30'000'000'000;
    (local ? hosts.local_ : hosts.remote_).jumped -= 30'000'000'000;
    hosts.run(1);
    EXPECT_EQ(hosts.tracker_.bound().jumps(), 1u);
    EXPECT_TRUE(hosts.holds());
  }
}

TEST(ClockTrackerTest, StampsAreConvertedWithTheirDoubt) {
  TwoHosts hosts({.base_s = 0.03}, {.base_s = 0.01}, {.start = 900'000'000'000}, 7);
  hosts.run(10);
  const Time<RobotClock> here{hosts.local_.at(hosts.now_)};
  const OperatorTime there{hosts.remote_.at(hosts.now_)};
  const auto seen = hosts.tracker_.to_here(there);
  ASSERT_TRUE(seen);
  EXPECT_LE(seen->earliest(), here);
  EXPECT_GE(seen->latest(), here);
  EXPECT_NEAR(to_seconds(seen->time - here), -0.01, 1e-3) << "half of the difference of the two ways";
  EXPECT_NEAR(to_seconds(seen->uncertainty), 0.02, 2e-3);
  const auto back = hosts.tracker_.to_there(here);
  EXPECT_LE(back->earliest(), there);
  EXPECT_GE(back->latest(), there);
  const auto delay = hosts.tracker_.delay(there, here + 50ms);
  EXPECT_LE(delay->delay - delay->uncertainty, 50ms);
  EXPECT_GE(delay->delay + delay->uncertainty, 50ms);
}

TEST(ClockTrackerTest, NothingIsKnownBeforeAnAnswerAndNonsenseIsNotBelieved) {
  ClockTracker<RobotClock, OperatorClock> tracker(9);
  EXPECT_FALSE(tracker.to_here({5}));
  const auto ping = tracker.ping({1'000'000'000});
  ASSERT_TRUE(ping);
  EXPECT_FALSE(tracker.ping({1'050'000'000})) << "not yet";
  EXPECT_EQ(tracker.pong({ping->number + 1, 1, 1}, {1'100'000'000}), ClockNews::stale) << "never asked";
  EXPECT_EQ(tracker.pong({ping->number, INT64_MIN, INT64_MAX}, {1'100'000'000}), ClockNews::nonsense);
  EXPECT_EQ(tracker.pong({ping->number, 1, 1}, {1'100'000'000}), ClockNews::stale) << "answered already";
  EXPECT_FALSE(tracker.to_here({5}));
  std::mt19937_64 random(1);
  OffsetBound bound;
  const auto any = [&] { return static_cast<std::int64_t>(random() >> random() % 60) * (random() % 8 == 0 ? -1 : 1); };
  for (int i = 0; i < 20'000; ++i) {
    bound.add({any(), any(), any(), any()});
    const auto at = bound.at(any());
    ASSERT_TRUE(!at || at->least <= at->most);
    bound.at_there(any());
  }
}

}  // namespace
}  // namespace foresight::clock_tracker_test
