#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/drives/cia402_states.hpp"
#include "sim/drives/object_dictionary.hpp"
#include "tests/drives/wire.hpp"

namespace foresight::sim::cia402_test {
namespace {

constexpr int kNode = 2;

// Makes RPDO 1 (controlword, target position) and TPDO 1 (statusword, position) synchronous.
void map_cyclic(Wire& wire, unsigned target = 0x607A0020) {
  wire.pass(5ms);
  for (unsigned direction : {0x1400u, 0x1800u}) {
    const unsigned id = direction == 0x1400 ? 0x202 : 0x182;
    ASSERT_EQ(wire.download(kNode, direction, 1, 0x80000000 | id, 4), 0u);
    ASSERT_EQ(wire.download(kNode, direction + 0x200, 0, 0, 1), 0u);
    ASSERT_EQ(wire.download(kNode, direction + 0x200, 1, direction == 0x1400 ? 0x60400010 : 0x60410010, 4), 0u);
    ASSERT_EQ(wire.download(kNode, direction + 0x200, 2, direction == 0x1400 ? target : 0x60640020, 4), 0u);
    ASSERT_EQ(wire.download(kNode, direction + 0x200, 0, 2, 1), 0u);
    ASSERT_EQ(wire.download(kNode, direction, 2, 1, 1), 0u);
    ASSERT_EQ(wire.download(kNode, direction, 1, id, 4), 0u);
  }
}

void cycle(Wire& wire, int controlword, std::int64_t target) {
  CanFrame pdo = frame(0x202, {controlword & 0xff, controlword >> 8, 0, 0, 0, 0});
  encode_integer(target, std::span(pdo.data).subspan(2, 4));
  wire.send(pdo);
  wire.send(0x80, {});
  wire.pass(10ms);
}

void start_profile(Wire& wire, std::int64_t target) {
  ASSERT_EQ(wire.download(kNode, 0x6060, 0, 1, 1), 0u);
  ASSERT_EQ(wire.download(kNode, 0x607A, 0, target, 4), 0u);
  wire.enable(kNode);
  EXPECT_EQ(wire.control(kNode, 0x1F) & 0x1000, 0x1000) << "set-point acknowledged";
}

// Every transition of the automaton, from where it starts to where it must lead.
TEST(PowerStates, MakesAllTransitions) {
  using enum PowerState;
  PowerStates states;
  EXPECT_EQ(states.state(), not_ready);
  states.control(0x0F);
  EXPECT_EQ(states.state(), not_ready) << "controlwords mean nothing yet";
  states.power_on();
  struct Step {
    int number, controlword;
    PowerState to;
  };
  for (const Step& step :
       {Step{0, 0x0F, switch_on_disabled}, Step{2, 6, ready_to_switch_on},  Step{3, 7, switched_on},
        Step{4, 15, operation_enabled},    Step{6, 6, ready_to_switch_on},  // 8
        Step{7, 0, switch_on_disabled},    Step{2, 6, ready_to_switch_on},  Step{7, 2, switch_on_disabled},
        Step{2, 6, ready_to_switch_on},    Step{3, 7, switched_on},         Step{6, 6, ready_to_switch_on},
        Step{3, 7, switched_on},           Step{10, 0, switch_on_disabled}, Step{2, 6, ready_to_switch_on},
        Step{34, 15, operation_enabled},   Step{9, 0, switch_on_disabled},  Step{2, 6, ready_to_switch_on},
        Step{34, 15, operation_enabled},   Step{11, 2, quick_stop_active},  Step{16, 15, quick_stop_active}}) {
    states.control(static_cast<std::uint16_t>(step.controlword));
    EXPECT_EQ(states.state(), step.to) << "transition " << step.number;
  }
  states.at_rest();
  EXPECT_EQ(states.state(), switch_on_disabled) << "transition 12";
  for (int word : {6, 7, 15}) states.control(static_cast<std::uint16_t>(word));
  states.control(7);
  EXPECT_EQ(states.state(), operation_enabled) << "it slows down first";
  EXPECT_EQ(states.braking(), Braking::slow_down);
  states.at_rest();
  EXPECT_EQ(states.state(), switched_on) << "transition 5";
  states.control(15);
  states.fault();
  EXPECT_EQ(states.state(), fault_reaction_active) << "transition 13";
  states.control(0);
  EXPECT_EQ(states.state(), fault_reaction_active);
  states.at_rest();
  EXPECT_EQ(states.state(), fault) << "transition 14";
  states.control(6);
  EXPECT_EQ(states.state(), fault);
  states.control(0x80);
  EXPECT_EQ(states.state(), switch_on_disabled) << "transition 15";
  states.fault();
  EXPECT_EQ(states.state(), fault) << "nothing to react with";
  states.control(0x80);
  EXPECT_EQ(states.state(), fault) << "the bit must rise";
}

TEST(PowerStates, StopsAsItsOptionsSay) {
  using enum PowerState;
  for (int option : {0, 1, 2, 3, 5, 6, 7}) {
    PowerStates states;
    states.options.quick_stop = option;
    states.power_on();
    for (int word : {6, 15, 2}) states.control(static_cast<std::uint16_t>(word));
    EXPECT_EQ(states.state(), option == 0 ? switch_on_disabled : quick_stop_active);
    states.at_rest();
    EXPECT_EQ(states.state(), option >= 5 ? quick_stop_active : switch_on_disabled) << option;
    if (option < 5) continue;
    EXPECT_TRUE(states.powered());
    states.control(15);
    EXPECT_EQ(states.state(), operation_enabled) << "transition 16";
  }
}

TEST(Cia402Node, ProfilePositionShakesHandsAndKeepsItsLimits) {
  Wire wire({cia402_drive(kNode)});
  wire.pass(5ms);
  wire.download(kNode, 0x6081, 0, 500, 4);
  wire.download(kNode, 0x6083, 0, 2000, 4);
  wire.download(kNode, 0x6084, 0, 1000, 4);
  start_profile(wire, 400);
  EXPECT_EQ(wire.status(kNode) & 0x0400, 0) << "on its way";
  EXPECT_EQ(wire.control(kNode, 0x0F) & 0x1000, 0) << "ready for another";
  wire.pass(2s);
  EXPECT_EQ(wire.status(kNode) & 0x0400, 0x0400) << "target reached";
  EXPECT_NEAR(wire.shaft().position, 0.4, 1e-3);
  EXPECT_EQ(wire.upload(kNode, 0x6064), 400);
  EXPECT_NEAR(wire.shaft().largest_velocity, 0.5, 0.01);
  EXPECT_LT(wire.shaft().largest_acceleration, 2.2);
  EXPECT_GT(wire.shaft().largest_acceleration, 1.8);
  // Relative, and a second one while the first runs.
  wire.download(kNode, 0x607A, 0, 100, 4);
  wire.control(kNode, 0x5F);
  wire.control(kNode, 0x4F);
  wire.download(kNode, 0x607A, 0, -300, 4);
  EXPECT_EQ(wire.control(kNode, 0x1F) & 0x1000, 0x1000);
  EXPECT_EQ(wire.control(kNode, 0x0F) & 0x1000, 0x1000) << "it waits, there is no room";
  wire.pass(4s);
  EXPECT_NEAR(wire.shaft().most_positive, 0.5, 2e-3);
  EXPECT_NEAR(wire.shaft().position, -0.3, 1e-3);
}

TEST(Cia402Node, HaltStopsAndLetsGoOn) {
  Wire wire({cia402_drive(kNode)});
  wire.pass(5ms);
  wire.download(kNode, 0x6081, 0, 500, 4);
  start_profile(wire, 1000);
  wire.pass(500ms);
  wire.control(kNode, 0x11F);
  wire.pass(500ms);
  const double there = wire.shaft().position;
  EXPECT_EQ(wire.status(kNode) & 0x0427, 0x0427) << "enabled, at rest";
  wire.pass(200ms);
  EXPECT_EQ(wire.shaft().position, there);
  EXPECT_LT(there, 0.6);
  wire.control(kNode, 0x1F);
  wire.pass(3s);
  EXPECT_NEAR(wire.shaft().position, 1, 1e-3);
}

TEST(Cia402Node, SoftwareLimitsCutTheTargetUnlessOff) {
  for (const bool off : {false, true}) {
    NodeConfig config = cia402_drive(kNode);
    config.motor.limits_off = off;
    Wire wire({config});
    wire.pass(5ms);
    wire.download(kNode, 0x607D, 1, -100, 4);
    wire.download(kNode, 0x607D, 2, 200, 4);
    wire.download(kNode, 0x6081, 0, 1000, 4);
    start_profile(wire, 900);
    EXPECT_EQ((wire.status(kNode) & 0x0800) != 0, !off) << "bit 11";
    wire.pass(4s);
    EXPECT_NEAR(wire.shaft().position, off ? 0.9 : 0.2, 1e-3);
  }
}

TEST(Cia402Node, FollowsCyclicPositionsAndMeasuresTheirAcceleration) {
  NodeConfig config = cia402_drive(kNode);
  config.counts_per_unit = 1e6;
  config.motor.limits_off = true;
  Wire wire({config});
  map_cyclic(wire);
  ASSERT_EQ(wire.download(kNode, 0x6060, 0, 8, 1), 0u);
  wire.enable(kNode);
  const double amplitude = 0.5, omega = 2;
  for (int k = 0; k < 700; ++k) cycle(wire, 15, std::llround(1e6 * amplitude * (1 - std::cos(omega * k * 0.01)) / 2));
  EXPECT_NEAR(wire.shaft().largest_velocity, amplitude * omega / 2, 0.01);
  EXPECT_NEAR(wire.shaft().largest_acceleration, amplitude * omega * omega / 2, 0.2) << "dry friction adds 0.1";
  EXPECT_NEAR(wire.shaft().most_positive, amplitude, 1e-3);
  EXPECT_EQ(wire.status(kNode) & 0x106F, 0x1027) << "bit 12: it follows";
}

TEST(Cia402Node, BridgesMissedSetPointsThenFaults) {
  for (const bool hold : {false, true}) {
    NodeConfig config = cia402_drive(kNode);
    config.counts_per_unit = 1e6;
    config.missed_set_points = 3;
    config.hold_when_missed = hold;
    Wire wire({config});
    map_cyclic(wire);
    ASSERT_EQ(wire.download(kNode, 0x6060, 0, 8, 1), 0u);
    wire.enable(kNode);
    int k = 0;
    for (; k < 100; ++k) cycle(wire, 15, 5000LL * std::min(k, 50) + (k > 50 ? 5000LL * (k - 50) : 0));
    const double before = wire.shaft().velocity;
    EXPECT_NEAR(before, 0.5, 0.02);
    for (int missed = 0; missed < 3; ++missed) {
      wire.send(0x80, {});
      wire.pass(10ms);
    }
    EXPECT_NEAR(wire.shaft().velocity, 0.5, 0.02) << "three are bridged";
    EXPECT_EQ(wire.status(kNode) & 0x6F, 0x27);
    wire.send(0x80, {});
    const auto after = wire.pass(500ms);
    const bool told = std::any_of(after.begin(), after.end(), [](const CanFrame& got) { return got.id == 0x82; });
    EXPECT_EQ(told, !hold);
    EXPECT_EQ(wire.status(kNode) & 0x6F, hold ? 0x27 : 0x08);
    EXPECT_EQ(wire.upload(kNode, 0x603F), hold ? 0 : static_cast<std::int16_t>(0x8250));
    EXPECT_LT(std::abs(wire.shaft().velocity), 1e-3);
    EXPECT_LT(wire.shaft().largest_acceleration, 10.2);
  }
}

TEST(Cia402Node, CyclicVelocityStopsAtTheSoftwareLimit) {
  NodeConfig config = cia402_drive(kNode);
  config.min_position = -0.5;
  config.max_position = 0.5;
  Wire wire({config});
  map_cyclic(wire, 0x60FF0020);
  ASSERT_EQ(wire.download(kNode, 0x6060, 0, 9, 1), 0u);
  wire.enable(kNode);
  for (int k = 0; k < 50; ++k) cycle(wire, 15, 300);
  EXPECT_NEAR(wire.shaft().velocity, 0.3, 0.01);
  for (int k = 0; k < 300; ++k) cycle(wire, 15, 300);
  EXPECT_NEAR(wire.shaft().position, 0.5, 0.01);
  EXPECT_LT(wire.shaft().most_positive, 0.502);
  EXPECT_EQ(wire.status(kNode) & 0x0800, 0x0800);
}

TEST(Cia402Node, HomesHereAndAtALimitSwitch) {
  NodeConfig config = cia402_drive(kNode);
  config.motor.start = 0.3;
  config.low_switch = -0.25;
  Wire wire({config});
  wire.pass(5ms);
  ASSERT_EQ(wire.download(kNode, 0x6060, 0, 6, 1), 0u);
  ASSERT_EQ(wire.download(kNode, 0x607C, 0, 50, 4), 0u);
  wire.enable(kNode);
  EXPECT_EQ(wire.upload(kNode, 0x6064), 0) << "an incremental encoder counts from where it woke";
  EXPECT_EQ(wire.status(kNode) & 0x1000, 0);
  EXPECT_EQ(wire.control(kNode, 0x1F) & 0x3000, 0x1000) << "method 37 is done at once";
  EXPECT_EQ(wire.upload(kNode, 0x6064), 50);
  wire.control(kNode, 0x0F);
  wire.download(kNode, 0x6098, 0, 17, 1);
  wire.download(kNode, 0x6099, 1, 200, 4);
  wire.download(kNode, 0x6099, 2, 20, 4);
  EXPECT_EQ(wire.control(kNode, 0x1F) & 0x3000, 0) << "on its way";
  wire.pass(8s);
  EXPECT_EQ(wire.status(kNode) & 0x3400, 0x1400) << "attained and at rest";
  const double zero = wire.shaft().position - static_cast<double>(*wire.upload(kNode, 0x6064)) / 1000;
  EXPECT_NEAR(zero, -0.25 - 0.05, 2e-3) << "the switch is at the home offset";
}

// 1016h watches the master; 6007h says what its silence does.
TEST(Cia402Node, StopsWhenItsMasterFallsSilentInMotion) {
  for (int option : {0, 1, 2, 3}) {
    Wire wire({cia402_drive(kNode)});
    wire.pass(5ms);
    ASSERT_EQ(wire.download(kNode, 0x1016, 1, 0x00010000 | 100, 4), 0u);
    ASSERT_EQ(wire.download(kNode, 0x6007, 0, option, 2), 0u);
    ASSERT_EQ(wire.download(kNode, 0x6085, 0, 3000, 4), 0u);
    ASSERT_EQ(wire.download(kNode, 0x6081, 0, 1000, 4), 0u);
    wire.send(0x701, {5});
    start_profile(wire, 100'000);
    for (int i = 0; i < 20; ++i) {
      wire.send(0x701, {5});
      wire.pass(50ms);
    }
    ASSERT_NEAR(wire.shaft().velocity, 1, 0.01) << "moving while the master lives";
    wire.rack.forget_extremes(0);
    const double before = wire.shaft().position;
    const auto frames = wire.pass(1s);
    EXPECT_TRUE(std::any_of(frames.begin(), frames.end(),
                            [](const CanFrame& f) { return text_of(f).starts_with("082#3081"); }));
    if (option == 0) {
      EXPECT_NEAR(wire.shaft().velocity, 1, 0.01);
      continue;
    }
    EXPECT_LT(std::abs(wire.shaft().velocity), 1e-3) << option;
    EXPECT_EQ(wire.status(kNode) & 0x4F, option == 1 ? 0x08 : 0x40) << option;
    // 100 ms of patience (the last beat was 50 ms ago), then v^2 / 2a; a brake stops harder than a ramp.
    const double ramp = 1.0 / (2 * 3.0);
    if (option == 2) {
      EXPECT_GT(wire.shaft().largest_acceleration, 20) << "the brake";
      continue;
    }
    EXPECT_NEAR(wire.shaft().position - before, 0.05 + ramp, 0.01) << option;
    EXPECT_LT(wire.shaft().largest_acceleration, 3.3) << option;
  }
}

TEST(Cia402Node, FaultsOnRequest) {
  Wire wire({cia402_drive(kNode)});
  wire.pass(5ms);
  start_profile(wire, 100'000);
  wire.pass(500ms);
  wire.rack.inject(0, DriveFault::overcurrent);
  const auto told = wire.wait(0x82);
  ASSERT_TRUE(told);
  EXPECT_EQ(text_of(*told).substr(0, 10), "082#102303");
  EXPECT_EQ(wire.status(kNode) & 0x4F, 0x08);
  wire.pass(500ms);
  EXPECT_EQ(wire.shaft().velocity, 0);
  wire.control(kNode, 0);
  EXPECT_EQ(wire.control(kNode, 0x80) & 0x4F, 0x40);
  EXPECT_EQ(wire.upload(kNode, 0x603F), 0);
  wire.rack.inject(0, DriveFault::silent);
  EXPECT_FALSE(wire.upload(kNode, 0x6041));
  wire.rack.inject(0, DriveFault::recover);
  wire.rack.inject(0, DriveFault::slow, 0.03);
  const RobotTime asked = wire.clock.now();
  EXPECT_TRUE(wire.upload(kNode, 0x6041));
  EXPECT_NEAR(to_seconds(wire.clock.now() - asked), 0.03, 0.002);
  wire.rack.inject(0, DriveFault::recover);
  wire.rack.inject(0, DriveFault::emergency, 0x4210);
  EXPECT_EQ(text_of(*wire.wait(0x82)).substr(0, 8), "082#1042");
}

TEST(Cia402Node, AJammedShaftIsAFollowingError) {
  Wire wire({cia402_drive(kNode)});
  wire.pass(5ms);
  start_profile(wire, 100'000);
  wire.pass(500ms);
  wire.rack.inject(0, DriveFault::jam);
  const auto told = wire.wait(0x82, 1s);
  ASSERT_TRUE(told);
  EXPECT_EQ(text_of(*told).substr(0, 8), "082#1186");
  wire.pass(100ms);
  EXPECT_EQ(wire.status(kNode) & 0x4F, 0x08);
}

TEST(Cia402Node, AResetInMotionLeavesTheShaftToItsBrake) {
  Wire wire({cia402_drive(kNode)});
  wire.pass(5ms);
  start_profile(wire, 100'000);
  wire.pass(1s);
  wire.rack.inject(0, DriveFault::reset);
  EXPECT_EQ(text_of(*wire.wait(0x702)), "702#00");
  wire.pass(500ms);
  EXPECT_EQ(wire.shaft().velocity, 0);
  EXPECT_TRUE(wire.shaft().brake_closed);
  EXPECT_EQ(wire.status(kNode) & 0x6F, 0x40);
}

TEST(Cia402Node, TellsFrozenAndArbitraryPositions) {
  Wire wire({cia402_drive(kNode)});
  wire.pass(5ms);
  start_profile(wire, 100'000);
  wire.pass(500ms);
  wire.rack.inject(0, DriveFault::frozen);
  const auto told = wire.upload(kNode, 0x6064);
  const double was = wire.shaft().position;
  wire.pass(300ms);
  EXPECT_EQ(wire.upload(kNode, 0x6064), told);
  EXPECT_GT(wire.shaft().position, was + 0.1) << "it moves on all the same";
  wire.rack.inject(0, DriveFault::recover);
  wire.rack.inject(0, DriveFault::garbage);
  const auto first = wire.upload(kNode, 0x6064), second = wire.upload(kNode, 0x6064);
  EXPECT_NE(first, second);
}

// Frames of every kind, but none that could rightly lead to power: controlwords never reach "enable operation".
TEST(Cia402Node, RandomFramesDoNotMoveADisabledShaft) {
  Wire wire({cia402_drive(kNode), powercube_module(5)});
  wire.pass(5ms);
  wire.send(0, {1, 0});
  std::mt19937 random(7);
  for (int i = 0; i < 10'000; ++i) {
    CanFrame noise;
    const std::uint32_t favourites[] = {0, 0x80, 0x202, 0x602, 0x302, 0x0C5, 0x0E5, 0x100, 0x701};
    noise.id = random() % 2 ? favourites[random() % 9] : random() % 0x800;
    noise.size = static_cast<std::uint8_t>(random() % 9);
    for (std::uint8_t& b : noise.data) b = static_cast<std::uint8_t>(random());
    if (noise.id == 0x202) noise.data[0] &= 0xF7;
    const bool writes_control = noise.id == 0x602 && noise.data[1] == 0x40 && noise.data[2] == 0x60;
    const bool homes = (noise.id == 0x0E5 || noise.id == 0x100) && noise.data[0] == 1;
    const bool maps = noise.id == 0x602 && noise.data[2] >= 0x14 && noise.data[2] <= 0x1B;
    if (writes_control || homes || maps) continue;
    wire.send(noise);
    if (i % 4 == 0) wire.pass(1ms);
  }
  wire.pass(100ms);
  for (std::size_t i : {0u, 1u}) {
    EXPECT_EQ(wire.shaft(i).position, 0);
    EXPECT_EQ(wire.shaft(i).largest_velocity, 0);
  }
  wire.send(0, {1, 2});
  EXPECT_TRUE(wire.upload(kNode, 0x1000)) << "and it still answers";
}

}  // namespace
}  // namespace foresight::sim::cia402_test
