// Every homing method of CiA 402 that emulated drives claim, from wherever the shaft stands.
#include "sim/drives/homing_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/drives/cia402_motion.hpp"
#include "tests/drives/wire.hpp"

namespace foresight::sim::homing_test {
namespace {

constexpr int kNode = 2;
constexpr double kHome = 0.25, kStep = 0.001;

/// A joint from -1 to 1 whose switches lie so that `method` finds kHome.
NodeConfig joint(int method, double start, double home = kHome) {
  NodeConfig config = cia402_drive(kNode);
  config.min_position = -1;
  config.max_position = 1;
  config.motor.min_stop = -1.1;
  config.motor.max_stop = 1.1;
  config.motor.start = start;
  place_homing_switches(config, method, home);
  return config;
}

struct Ended {
  std::optional<double> home;
  bool failed = false;
  double seconds = 0;
  double lowest = 0, highest = 0;
};

/// The drive's motion alone, with a shaft that follows at once.
Ended search(const NodeConfig& config, int method) {
  Cia402Motion motion;
  motion.settings.homing_method = method;
  motion.settings.homing_fast = 0.2;
  motion.settings.homing_slow = 0.05;
  motion.settings.homing_acceleration = 1;
  motion.settings.index_distance = config.index_distance;
  motion.settings.index_at = config.index_at;
  motion.want_mode(Mode::homing);
  motion.hold(config.motor.start);
  Ended out;
  out.lowest = out.highest = config.motor.start;
  if (!motion.start_homing()) return out;
  for (double x = config.motor.start; out.seconds < 120 && !out.home && !out.failed; out.seconds += kStep) {
    const unsigned inputs = (x <= config.low_switch ? kNegativeLimit : 0) |
                            (x >= config.high_switch ? kPositiveLimit : 0) |
                            (x >= config.home_switch_low && x <= config.home_switch_high ? kHomeSwitch : 0);
    x = motion.step(kStep, Braking::none, false, x, inputs).position;
    out.lowest = std::min(out.lowest, x);
    out.highest = std::max(out.highest, x);
    out.home = motion.take_home();
    out.failed = motion.take_homing_failure();
  }
  return out;
}

TEST(Homing, EveryMethodFindsItsHomeFromAnyPose) {
  for (const int method : served_homing_methods()) {
    if (method >= 33) continue;
    for (double start = -0.98; start < 1; start += 0.07) {
      const Ended ended = search(joint(method, start), method);
      ASSERT_TRUE(ended.home) << "method " << method << " from " << start << (ended.failed ? " failed" : " never ends");
      EXPECT_NEAR(*ended.home, kHome, 1e-4) << "method " << method << " from " << start;
      // Onto a limit switch, and no farther than it takes to stop.
      EXPECT_GT(ended.lowest, -1.05) << "method " << method << " from " << start;
      EXPECT_LT(ended.highest, 1.05) << "method " << method << " from " << start;
    }
  }
}

// The next index pulse is the right one only on the right side of it.
TEST(Homing, TheIndexPulseAloneIsLookedForInOneDirection) {
  for (const double start : {-0.9, 0.0, 0.2})
    EXPECT_NEAR(search(joint(34, start), 34).home.value_or(9), kHome, 1e-9) << start;
  for (const double start : {0.3, 0.9})
    EXPECT_NEAR(search(joint(33, start), 33).home.value_or(9), kHome, 1e-9) << start;
  EXPECT_TRUE(search(joint(33, 0.0), 33).failed) << "at the negative limit switch";
  EXPECT_TRUE(search(joint(34, 0.5), 34).failed) << "at the positive limit switch";
}

TEST(Homing, ASwitchThatIsNotThereIsAnErrorNotAHang) {
  for (const int method : {3, 5, 8, 10, 12, 14, 19, 22, 27}) {
    NodeConfig config = joint(method, 0);
    config.home_switch_low = 1;
    config.home_switch_high = 0;
    EXPECT_TRUE(search(config, method).failed) << method;
  }
  NodeConfig stuck = joint(20, 0);
  stuck.home_switch_low = -1e9;
  EXPECT_TRUE(search(stuck, 20).failed) << "a switch that never opens";
}

TEST(Homing, ServesTheNumbersOfTheStandardAndNoOthers) {
  const auto& served = served_homing_methods();
  EXPECT_EQ(served.size(), 14u + 14 + 2 + 2);
  for (const int none : {-1, 0, 15, 16, 31, 32, 36, 38}) EXPECT_FALSE(homing_method(none)) << none;
}

/// Homed over the wire; the status word at the end.
std::uint16_t home(Wire& wire, int method) {
  wire.pass(5ms);
  EXPECT_EQ(wire.download(kNode, 0x6060, 0, 6, 1), 0u);
  EXPECT_EQ(wire.download(kNode, 0x6098, 0, method, 1), 0u);
  for (const auto& [sub, speed] : {std::pair{1u, 500}, {2u, 100}}) wire.download(kNode, 0x6099, sub, speed, 4);
  wire.download(kNode, 0x609A, 0, 2000, 4);
  wire.enable(kNode);
  wire.control(kNode, 0x1F);
  for (int i = 0; i < 300 && (wire.status(kNode) & 0x3000) == 0; ++i) wire.pass(100ms);
  return wire.status(kNode) & 0x3400;
}

TEST(Homing, OverTheWireTheDriveSaysZeroAtHome) {
  for (const int method : {1, 2, 4, 7, 17, 24, 28}) {
    Wire wire({joint(method, -0.4)});
    EXPECT_EQ(home(wire, method), 0x1400) << "method " << method << ": attained and at rest";
    const double zero = wire.shaft().position - static_cast<double>(wire.upload(kNode, 0x6064).value()) / 1000;
    EXPECT_NEAR(zero, kHome, 2e-3) << method;
  }
  Wire wrong({joint(33, -0.4)});
  EXPECT_EQ(home(wrong, 33), 0x2400) << "homing error, at rest";
  EXPECT_LT(std::abs(wrong.shaft().velocity), 1e-3);
}

TEST(Homing, TheDriveListsItsMethodsAndTakesNoOther) {
  NodeConfig config = joint(17, 0);
  config.homing_methods = {17, 33, 37};
  Wire wire({config});
  wire.pass(5ms);
  EXPECT_EQ(wire.upload(kNode, 0x60E3, 0), 3);
  EXPECT_EQ(wire.upload(kNode, 0x60E3, 2), 33);
  EXPECT_EQ(wire.download(kNode, 0x6098, 0, 33, 1), 0u);
  EXPECT_EQ(wire.download(kNode, 0x6098, 0, 18, 1), 0x06090030u) << "a value out of range";
  EXPECT_EQ(wire.upload(kNode, 0x6098), 33) << "stays";
  Wire all({cia402_drive(kNode)});
  all.pass(5ms);
  EXPECT_EQ(all.upload(kNode, 0x60E3, 0), static_cast<std::int64_t>(served_homing_methods().size()));
  EXPECT_EQ(all.download(kNode, 0x6098, 0, 15, 1), 0x06090030u) << "reserved";
}

TEST(Homing, TheHomeSwitchIsADigitalInput) {
  NodeConfig config = joint(20, 0.5);
  Wire wire({config});
  wire.pass(5ms);
  EXPECT_EQ(wire.upload(kNode, 0x60FD), kHomeSwitch);
  EXPECT_EQ(wire.status(kNode) & 0x0800, 0) << "no limit";
}

}  // namespace
}  // namespace foresight::sim::homing_test
