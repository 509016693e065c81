#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "common/error.hpp"
#include "sim/drives/rack_presets.hpp"
#include "tests/drives/wire.hpp"

namespace foresight::sim {
namespace {

using testing::HasSubstr;

std::string error_of(std::vector<NodeConfig> nodes) {
  try {
    Wire wire(nodes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(DriveRack, RefusesWhatCannotBe) {
  EXPECT_THAT(error_of({cia402_drive(3), cia402_drive(3)}), HasSubstr("node 3"));
  EXPECT_THAT(error_of({powercube_module(32)}), HasSubstr("node is 32"));
  NodeConfig config = cia402_drive(3);
  config.counts_per_unit = 0;
  EXPECT_THAT(error_of({config}), HasSubstr("counts_per_unit is 0"));
  config = cia402_drive(3);
  config.dictionary = "/nonexistent.dcf";
  EXPECT_THAT(error_of({config}), HasSubstr("/nonexistent.dcf"));
  EXPECT_EQ(error_of(powercube_rack()), "");
  EXPECT_EQ(error_of(cia402_rack()), "");
}

TEST(DriveRack, MayGoBeforeItsClock) {
  SteppedClock clock;
  InProcessBus bus("can0", clock);
  {
    const DriveRack rack(clock, bus.attach(), cia402_rack());
    clock.sleep_until(clock.now() + 10ms);
  }
  clock.sleep_until(clock.now() + 10ms);
}

// The same frames in, the same frames out, at the same instants.
TEST(DriveRack, IsDeterministic) {
  const auto record = [] {
    std::vector<NodeConfig> nodes = powercube_rack();
    for (NodeConfig config : cia402_rack()) {
      config.name += "_402";
      nodes.push_back(config);
    }
    Wire wire(nodes);
    std::mt19937 random(3);
    std::vector<std::string> out;
    wire.send(0, {1, 0});
    wire.send(0x100, {0x01});
    for (int i = 0; i < 3000; ++i) {
      CanFrame noise;
      const std::uint32_t ids[] = {0x80, 0x203, 0x204, 0x603, 0x604, 0x0C1, 0x0E1, 0x0E8, 0x100};
      noise.id = ids[random() % 9];
      noise.size = static_cast<std::uint8_t>(random() % 9);
      for (std::uint8_t& b : noise.data) b = static_cast<std::uint8_t>(random() % 16);
      wire.send(noise);
      if (i % 3 == 0) wire.send(0x0C1, {0x0A, 0x3C});
      if (i % 3 == 1) wire.send(0x603, {0x40, 0x64, 0x60, 0, 0, 0, 0, 0});
      if (i == 1500) wire.rack.inject(0, DriveFault::garbage);
      for (const CanFrame& got : wire.pass(1ms)) out.push_back(std::to_string(got.time.ns) + " " + text_of(got));
    }
    return out;
  };
  const auto first = record(), second = record();
  EXPECT_GT(first.size(), 2000u);
  EXPECT_EQ(first, second);
}

TEST(DriveRack, RunsInRealTime) {
  MonotonicClock clock;
  InProcessBus bus("can0", clock);
  const auto end = bus.attach();
  DriveRack rack(clock, bus.attach(), {cia402_drive(2)});
  std::jthread thread([&](std::stop_token stop) { rack.run(stop); });
  EXPECT_EQ(text_of(end->receive(2s).value_or(CanFrame{})), "702#00");
  end->send(frame(0x602, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0}));
  const auto answer = end->receive(2s);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->id, 0x582u);
  EXPECT_EQ(rack.shaft(0).position, 0);
}

}  // namespace
}  // namespace foresight::sim
