#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <thread>

#include "common/error.hpp"
#include "sim/drives/rack_presets.hpp"
#include "tests/drives/wire.hpp"

namespace foresight::sim::rack_test {
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
  const auto end = bus.attach();
  const auto heard = [&] {
    int frames = 0;
    while (end->receive(0ms)) ++frames;
    return frames;
  };
  {
    const DriveRack rack(clock, bus.attach(), cia402_rack());
    clock.sleep_until(clock.now() + 10ms);
    EXPECT_GT(heard(), 0);
  }
  clock.sleep_until(clock.now() + 10s);
  EXPECT_EQ(heard(), 0) << "its nodes are gone with it";
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

/// Frames that came at known instants, however late they are read.
class LateBus final : public CanBus {
 public:
  const std::string& name() const noexcept override { return name_; }
  CanSend send(const CanFrame& frame) noexcept override {
    sent.push_back(frame);
    return CanSend::sent;
  }
  std::optional<CanFrame> receive(Duration) noexcept override {
    if (coming.empty() || coming.front().time > now) return std::nullopt;
    const CanFrame out = coming.front();
    coming.pop_front();
    return out;
  }
  CanBusState state() const noexcept override { return CanBusState::active; }
  CanCounters counters() const noexcept override { return {}; }

  std::deque<CanFrame> coming;
  std::vector<CanFrame> sent;
  RobotTime now;

 private:
  std::string name_ = "late";
};

TEST(DriveRack, HeldUpItDoesNotTakeItsMasterForSilent) {
  MonotonicClock clock;
  const RobotTime start = clock.now() + 1s;
  auto owned = std::make_unique<LateBus>();
  LateBus& bus = *owned;
  DriveRack rack(clock, std::move(owned), {powercube_module(1)});
  for (int at_ms : {0, 60, 120, 180, 185}) {
    bus.coming.push_back(at_ms < 185 ? frame(0x100, {0x07}) : frame(0x0C1, {0x0A, 0x27}));
    bus.coming.back().time = start + at_ms * 1ms;
  }
  // Its watchdog allows 100 ms of silence. The refreshes of 60 and 120 ms are both read at 149 ms.
  for (int at_ms : {0, 59, 149, 179, 190}) {
    bus.now = start + at_ms * 1ms;
    rack.step(bus.now);
  }
  ASSERT_FALSE(bus.sent.empty());
  EXPECT_EQ(bus.sent.back().data[1], 0x27);
  EXPECT_EQ(bus.sent.back().data[2] & 0x01, 0) << "its watchdog has stopped it";
}

TEST(DriveRack, RunsInRealTime) {
  MonotonicClock clock;
  InProcessBus bus("can0", clock);
  const auto end = bus.attach();
  DriveRack rack(clock, bus.attach(), {cia402_drive(2)});
  std::jthread thread([&](std::stop_token stop) { rack.run(stop); });
  EXPECT_EQ(text_of(end->receive(60s).value_or(CanFrame{})), "702#00");
  end->send(frame(0x602, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0}));
  const auto answer = end->receive(60s);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->id, 0x582u);
  EXPECT_EQ(rack.shaft(0).position, 0);
}

}  // namespace
}  // namespace foresight::sim::rack_test
