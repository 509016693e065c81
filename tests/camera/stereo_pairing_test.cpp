// Thousands of frames in simulated time.
#include "drivers/camera/stereo_pairing.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace foresight::stereo_pairing_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPeriod{33'333'333};

/// Two cameras at 30 fps, the right one late by up to 3 ms, both delivered 40 to 60 ms after capture.
class Rig {
 public:
  explicit Rig(const PairingOptions& options = {}) : pairing(options) {}

  ColourImage image(Side side, std::int64_t i, Duration shift = 0ns) {
    ColourImage out;
    out.sequence = static_cast<std::uint64_t>(i);
    const Duration jitter{side == Side::right ? static_cast<std::int64_t>(random_() % 3'000'000) : 0};
    out.time = RobotTime{(i + 1) * kPeriod.count()} + jitter + shift;
    return out;
  }
  RobotTime arrival(std::int64_t i) {
    return RobotTime{(i + 1) * kPeriod.count()} + 40ms + Duration(random_() % 20'000'000);
  }
  std::optional<StereoPair> add(Side side, std::int64_t i, Duration shift = 0ns) {
    now = std::max(now, arrival(i));
    return pairing.add(side, image(side, i, shift), now);
  }

  StereoPairing pairing;
  RobotTime now;

 private:
  std::mt19937 random_{1};
};

TEST(StereoPairing, PairsAllOfTwoGoodCameras) {
  Rig rig;
  EXPECT_STREQ(rig.pairing.reason(RobotTime{}), "no image yet");
  int pairs = 0;
  for (int i = 0; i < 5000; ++i) {
    // Now the one, now the other arrives first.
    const Side first = i % 3 == 0 ? Side::right : Side::left;
    EXPECT_FALSE(rig.add(first, i));
    const auto pair = rig.add(first == Side::left ? Side::right : Side::left, i);
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->left.sequence, pair->right.sequence);
    EXPECT_LE(pair->right.time - pair->left.time, 3ms);
    ++pairs;
  }
  EXPECT_EQ(rig.pairing.counters().pairs, 5000u);
  EXPECT_EQ(rig.pairing.counters().unpaired[0] + rig.pairing.counters().unpaired[1], 0u);
  EXPECT_STREQ(rig.pairing.reason(rig.now), "");
}

TEST(StereoPairing, LostFramesStayUnpairedAndNothingIsMixedUp) {
  Rig rig;
  std::mt19937 random(2);
  std::array<std::uint64_t, 2> delivered{};
  std::uint64_t both = 0;
  RobotTime last{};
  for (int i = 0; i < 10'000; ++i) {
    const bool left = random() % 10 != 0, right = random() % 10 != 0;
    both += left && right;
    std::optional<StereoPair> pair;
    if (left && ++delivered[0]) pair = rig.add(Side::left, i);
    ASSERT_FALSE(pair);
    if (right && ++delivered[1]) pair = rig.add(Side::right, i);
    ASSERT_EQ(pair.has_value(), left && right);
    if (!pair) continue;
    EXPECT_EQ(pair->left.sequence, pair->right.sequence);
    EXPECT_GT(pair->left.time, last);
    last = pair->left.time;
  }
  const auto& counters = rig.pairing.counters();
  EXPECT_EQ(counters.pairs, both);
  for (std::size_t side : {0u, 1u}) {
    // Up to 4 still wait for a partner.
    EXPECT_LE(counters.pairs + counters.unpaired[side], delivered[side]);
    EXPECT_GE(counters.pairs + counters.unpaired[side] + 4, delivered[side]);
  }
}

TEST(StereoPairing, ALateCameraStillPairs) {
  Rig rig;
  int pairs = 0;
  for (int i = 0; i < 1000; ++i) {
    rig.add(Side::left, i);
    if (i >= 3) pairs += rig.add(Side::right, i - 3).has_value();
  }
  EXPECT_EQ(pairs, 997);
}

TEST(StereoPairing, AFrozenCameraIsNamed) {
  Rig rig;
  for (int i = 0; i < 100; ++i) {
    rig.add(Side::left, i);
    rig.add(Side::right, i);
  }
  for (int i = 100; i < 130; ++i) EXPECT_FALSE(rig.add(Side::left, i));
  EXPECT_STREQ(rig.pairing.reason(rig.now), "the right camera is frozen");
  EXPECT_GE(rig.pairing.counters().unpaired[0], 26u);
  EXPECT_STREQ(rig.pairing.reason(rig.now + 10s), "both cameras are frozen");
  rig.add(Side::left, 130);
  EXPECT_TRUE(rig.add(Side::right, 130));
  EXPECT_STREQ(rig.pairing.reason(rig.now), "");
}

TEST(StereoPairing, ACameraThatNeverBeganIsNamed) {
  Rig rig;
  for (int i = 0; i < 30; ++i) rig.add(Side::right, i);
  EXPECT_STREQ(rig.pairing.reason(rig.now), "the left camera is frozen");
}

void expect_jump(Duration jump, int frames) {
  Rig rig;
  int i = 0;
  const auto both = [&](Duration shift) {
    rig.add(Side::left, i, shift);
    return rig.add(Side::right, i++).has_value();
  };
  for (int k = 0; k < 100; ++k) both(0ns);
  for (int k = 0; k < frames; ++k) EXPECT_FALSE(both(jump)) << to_seconds(jump);
  EXPECT_STREQ(rig.pairing.reason(rig.now), "the left camera's capture times jump");
  for (int k = 0; k < 30; ++k) both(0ns);
  EXPECT_TRUE(both(0ns)) << "trusted again, after " << to_seconds(jump);
  EXPECT_STREQ(rig.pairing.reason(rig.now), "");
  EXPECT_GE(rig.pairing.counters().jumps[0], static_cast<std::uint64_t>(frames));
  EXPECT_EQ(rig.pairing.counters().jumps[1], 0u);
}

TEST(StereoPairing, JumpingClocksAreNotTrusted) {
  for (Duration jump : {Duration(10s), Duration(-10s), Duration(1h), Duration(-300ms)}) {
    expect_jump(jump, 1);
    if (jump != Duration(-300ms)) expect_jump(jump, 50);
  }
}

TEST(StereoPairing, TimesThatStandStillAreNotTrusted) {
  Rig rig;
  for (int i = 0; i < 10; ++i) {
    rig.pairing.add(Side::left, rig.image(Side::left, 5), rig.now = RobotTime{} + 250ms + i * 1ms);
  }
  rig.add(Side::right, 6);
  EXPECT_STREQ(rig.pairing.reason(rig.now), "the left camera's capture times jump");
  EXPECT_EQ(rig.pairing.counters().jumps[0], 9u);
}

TEST(StereoPairing, TooFarApartIsNoPair) {
  Rig rig;
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(rig.add(Side::left, i));
    EXPECT_FALSE(rig.add(Side::right, i, 12ms));
  }
  EXPECT_EQ(rig.pairing.counters().pairs, 0u);
}

}  // namespace
}  // namespace foresight::stereo_pairing_test
