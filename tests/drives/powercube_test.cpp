#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "sim/drives/object_dictionary.hpp"
#include "tests/drives/wire.hpp"

namespace foresight::sim::powercube_test {
namespace {

constexpr int kModule = 5;
constexpr int kRamp = 0x04, kVelocity = 0x07, kRampAck = 0x0E, kStepAck = 0x10;
constexpr std::uint32_t kError = 1, kHomeOk = 2, kHalted = 4, kTowError = 0x10, kCommError = 0x20, kMotion = 0x800,
                        kRampEnd = 0x8000, kBeyondSoft = 0x4000000;

float position_of(const CanFrame& ack) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(decode_integer(ack.payload().subspan(2, 4), false)));
}

void set(Wire& wire, int parameter, std::uint32_t bits) {
  CanFrame out = frame(0x0E0 + kModule, {0x08, parameter, 0, 0, 0, 0});
  encode_integer(bits, std::span(out.data).subspan(2, 4));
  wire.send(out);
}

TEST(PowerCubeNode, RefusesMotionUntilHomed) {
  Wire wire({powercube_module(kModule)});
  EXPECT_EQ(wire.state(kModule) & kHomeOk, 0u);
  EXPECT_FALSE(wire.motion(kModule, kRamp, 0.5f)) << "no simple acknowledge";
  const auto refused = wire.motion(kModule, kRampAck, 0.5f);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->size, 8);
  EXPECT_EQ(refused->data[6] & 0x01, 0x01) << "NOT_OK";
  wire.pass(500ms);
  EXPECT_EQ(wire.shaft().position, 0);
  wire.home(kModule);
  EXPECT_EQ(text_of(*wire.motion(kModule, kRamp, 0.5f)), "0A5#0B0464");
  wire.pass(2s);
  EXPECT_NEAR(wire.shaft().position, 0.5, 1e-3);
  EXPECT_EQ(wire.state(kModule) & (kRampEnd | kMotion), kRampEnd);
  EXPECT_NEAR(*wire.real(kModule, 0x3C), 0.5, 1e-3);
}

TEST(PowerCubeNode, HomesFromWhereverItWoke) {
  NodeConfig config = powercube_module(kModule);
  config.motor.start = 0.7;
  config.home_position = 0.1;
  Wire wire({config});
  EXPECT_EQ(*wire.real(kModule, 0x3C), 0) << "it does not know where it is";
  wire.home(kModule);
  EXPECT_NEAR(wire.shaft().position, 0.1, 1e-3);
  EXPECT_NEAR(*wire.real(kModule, 0x3C), 0.1, 1e-3);
  EXPECT_LT(wire.shaft().largest_velocity, 0.11);
  wire.rack.inject(0, DriveFault::reset);
  EXPECT_FALSE(wire.real(kModule, 0x3C)) << "it boots";
  wire.pass(400ms);
  EXPECT_EQ(wire.state(kModule) & kHomeOk, 0u) << "nothing is kept";
}

TEST(PowerCubeNode, RampsKeepSpeedAndAcceleration) {
  NodeConfig config = powercube_module(kModule);
  config.homed = true;
  Wire wire({config});
  set(wire, 0x4F, std::bit_cast<std::uint32_t>(0.4f));
  EXPECT_EQ(text_of(*wire.wait(0x0A5)), "0A5#084F64");
  set(wire, 0x50, std::bit_cast<std::uint32_t>(1.5f));
  ASSERT_TRUE(wire.wait(0x0A5));
  EXPECT_EQ(*wire.real(kModule, 0x4F), 0.4f);
  ASSERT_TRUE(wire.motion(kModule, kRamp, 1.0f));
  wire.pass(100ms);
  EXPECT_EQ(wire.state(kModule) & 0x7000, 0x1000u) << "accelerates";
  wire.pass(1s);
  EXPECT_EQ(wire.state(kModule) & 0x7000, 0x2000u) << "steady";
  wire.pass(3s);
  EXPECT_NEAR(wire.shaft().position, 1, 1e-3);
  EXPECT_NEAR(wire.shaft().largest_velocity, 0.4, 0.005);
  EXPECT_LT(wire.shaft().largest_acceleration, 1.7);
  EXPECT_GT(wire.shaft().largest_acceleration, 1.3);
}

TEST(PowerCubeNode, RefusesWhatMakesNoSense) {
  NodeConfig config = powercube_module(kModule);
  config.homed = true;
  Wire wire({config});
  EXPECT_FALSE(wire.motion(kModule, kRamp, NAN));
  EXPECT_FALSE(wire.motion(kModule, kVelocity, INFINITY));
  EXPECT_FALSE(wire.motion(kModule, 0x05, 0.1f)) << "no such motion";
  EXPECT_FALSE(wire.motion(kModule, kRamp, 0.1f, 10)) << "too long";
  EXPECT_FALSE(wire.motion(6, kRamp, 0.1f)) << "no such module";
  set(wire, 0x50, std::bit_cast<std::uint32_t>(-1.0f));
  EXPECT_FALSE(wire.wait(0x0A5, 5ms));
  set(wire, 0x1A, 5);
  EXPECT_FALSE(wire.wait(0x0A5, 5ms)) << "the serial number is the maker's";
  wire.send(0x0C5, {0x0A, 0x1A});
  EXPECT_EQ(text_of(*wire.wait(0x0A5)), "0A5#0A1A67120000");
  wire.pass(1s);
  EXPECT_EQ(wire.shaft().position, 0);
}

TEST(PowerCubeNode, CutsTargetsAtTheSoftLimits) {
  NodeConfig config = powercube_module(kModule);
  config.homed = true;
  Wire wire({config});
  ASSERT_TRUE(wire.motion(kModule, kRamp, 3.0f));
  wire.pass(4s);
  EXPECT_NEAR(wire.shaft().position, 1.5, 1e-3);
  EXPECT_TRUE(wire.state(kModule) & kBeyondSoft);
  ASSERT_TRUE(wire.motion(kModule, kVelocity, -1.0f));
  wire.pass(6s);
  EXPECT_NEAR(wire.shaft().position, -1.5, 1e-3);
  EXPECT_GT(wire.shaft().most_negative, -1.502);
}

TEST(PowerCubeNode, FollowsCyclicStepsAndAnswersEach) {
  NodeConfig config = powercube_module(kModule);
  config.homed = true;
  config.motor.limits_off = true;
  Wire wire({config});
  const double amplitude = 1, omega = 2;
  for (int k = 0; k < 400; ++k) {
    const auto ack =
        wire.motion(kModule, kStepAck, static_cast<float>(amplitude * (1 - std::cos(omega * k * 0.02)) / 2), 20);
    ASSERT_TRUE(ack);
    EXPECT_NEAR(position_of(*ack), wire.shaft().position, 2e-3);
    EXPECT_EQ(ack->data[6] & 0x01, 0) << "OK";
    wire.pass(20ms - Duration(wire.clock.now().ns % 20'000'000));
  }
  EXPECT_NEAR(wire.shaft().largest_velocity, amplitude * omega / 2, 0.02);
  EXPECT_NEAR(wire.shaft().largest_acceleration, amplitude * omega * omega / 2, 0.3);
  wire.pass(300ms);
  EXPECT_LT(std::abs(wire.shaft().velocity), 1e-3) << "no further steps: it stops";
}

TEST(PowerCubeNode, ALongStepTakesItsTime) {
  NodeConfig config = powercube_module(kModule);
  config.homed = true;
  Wire wire({config});
  ASSERT_TRUE(wire.motion(kModule, 0x06, 0.6f, 2000));
  wire.pass(1s);
  EXPECT_NEAR(wire.shaft().position, 0.3, 0.01);
  wire.pass(1s);
  EXPECT_NEAR(wire.shaft().position, 0.6, 0.01);
  EXPECT_NEAR(wire.shaft().largest_velocity, 0.6, 0.02);
}

TEST(PowerCubeNode, HaltNeedsReset) {
  NodeConfig config = powercube_module(kModule);
  config.homed = true;
  Wire wire({config});
  ASSERT_TRUE(wire.motion(kModule, kVelocity, 0.5f));
  wire.pass(500ms);
  EXPECT_NEAR(wire.shaft().velocity, 0.5, 0.01);
  wire.send(0x100, {0x02});
  wire.pass(500ms);
  EXPECT_EQ(wire.shaft().velocity, 0);
  EXPECT_TRUE(wire.shaft().brake_closed);
  EXPECT_TRUE(wire.state(kModule) & kHalted);
  EXPECT_FALSE(wire.motion(kModule, kVelocity, 0.5f));
  wire.send(0x0E5, {0x00});
  EXPECT_EQ(text_of(*wire.wait(0x0A5)), "0A5#0064");
  EXPECT_FALSE(wire.state(kModule) & kHalted);
  EXPECT_TRUE(wire.motion(kModule, kVelocity, 0.5f));
}

// The master is killed in motion: the refreshes end, and the module stops by itself. Without the watchdog it would
// not.
TEST(PowerCubeNode, TheWatchdogStopsWhatAMasterLeftMoving) {
  for (const bool watched : {false, true}) {
    NodeConfig config = powercube_module(kModule);
    config.homed = true;
    config.max_position = 100;
    config.motor.max_acceleration = 2;
    Wire wire({config});
    wire.send(0x0C5, {0x0A, 0x39});
    EXPECT_EQ(text_of(*wire.wait(0x0A5)), "0A5#0A3900000000");
    set(wire, 0x39, watched ? 0x01000000 : 0);
    ASSERT_TRUE(wire.wait(0x0A5));
    ASSERT_TRUE(wire.motion(kModule, kVelocity, 1.0f));
    for (int i = 0; i < 50; ++i) {
      if (watched) wire.send(0x100, {0x07});
      wire.pass(40ms);
    }
    ASSERT_NEAR(wire.shaft().velocity, 1, 0.01);
    const double before = wire.shaft().position;
    wire.pass(2s);
    if (!watched) {
      EXPECT_NEAR(wire.shaft().velocity, 1, 0.01);
      continue;
    }
    EXPECT_EQ(wire.shaft().velocity, 0);
    EXPECT_NEAR(wire.shaft().position - before, 0.06 + 1.0 / (2 * 2), 0.01) << "100 ms of patience, then v^2 / 2a";
    EXPECT_EQ(wire.state(kModule) & (kError | kHalted | kCommError), kError | kHalted | kCommError);
    EXPECT_LT(wire.shaft().largest_acceleration, 2.2);
  }
}

TEST(PowerCubeNode, FaultsOnRequest) {
  NodeConfig config = powercube_module(kModule);
  config.homed = true;
  Wire wire({config});
  ASSERT_TRUE(wire.motion(kModule, kVelocity, 0.5f));
  wire.pass(300ms);
  wire.rack.inject(0, DriveFault::tow_error);
  wire.pass(500ms);
  EXPECT_EQ(wire.state(kModule) & (kError | kTowError), kError | kTowError);
  EXPECT_EQ(wire.shaft().velocity, 0);
  wire.send(0x0E5, {0x00});
  ASSERT_TRUE(wire.motion(kModule, kVelocity, 0.5f));
  wire.pass(300ms);
  wire.rack.inject(0, DriveFault::jam);
  wire.pass(1s);
  EXPECT_EQ(wire.state(kModule) & (kError | kTowError), kError | kTowError) << "a shaft held fast";
  wire.rack.inject(0, DriveFault::recover);
  wire.rack.inject(0, DriveFault::garbage);
  int finite = 0, wild = 0;
  for (int i = 0; i < 50; ++i) ++(std::isfinite(*wire.real(kModule, 0x3C)) ? finite : wild);
  EXPECT_GT(finite, 5);
  EXPECT_GT(wild, 5);
  wire.rack.inject(0, DriveFault::silent);
  EXPECT_FALSE(wire.real(kModule, 0x3C));
}

TEST(PowerCubeNode, SyncMotionStartsAllAtOnce) {
  NodeConfig first = powercube_module(1), second = powercube_module(2);
  first.homed = second.homed = true;
  Wire wire({first, second});
  for (unsigned module : {1u, 2u}) {
    wire.send(0x0E0 + module, {0x08, 0x39, 0, 0, 0, 0x08});
    ASSERT_TRUE(wire.wait(0x0A0 + module));
    ASSERT_TRUE(wire.motion(static_cast<int>(module), kRamp, 0.2f));
    wire.pass(100ms);
  }
  EXPECT_EQ(wire.shaft(0).position, 0);
  wire.send(0x100, {0x0F});
  wire.pass(50ms);
  EXPECT_GT(wire.shaft(0).position, 0);
  EXPECT_EQ(wire.shaft(0).position, wire.shaft(1).position);
}

}  // namespace
}  // namespace foresight::sim::powercube_test
