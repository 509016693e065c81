// The master against scripted modules, in stepped time.
#include "drivers/powercube/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/error.hpp"
#include "scripted_module.hpp"
#include "tests/support/allocations.hpp"

namespace foresight::powercube::network_test {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::HasSubstr;

DriveConfig joint(const std::string& name, int node) {
  DriveConfig c;
  c.name = name;
  c.node = node;
  c.min_position = -1;
  c.max_position = 1.5;
  c.max_velocity = 2;
  c.max_acceleration = 4;
  return c;
}

class PowerCube : public testing::Test {
 protected:
  PowerCube() : bus_("can0", clock_), end_(bus_.attach()), shoulder_(bus_, clock_, 3), elbow_(bus_, clock_, 4) {}

  void start(const Options& options = {}, std::vector<DriveConfig> joints = {joint("shoulder", 3), joint("elbow", 4)}) {
    network_ = std::make_unique<Network>(*end_, clock_, joints, options);
    for (Drive* drive : network_->drives()) {
      drive->identify();
      drive->configure();
    }
    run(10);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      const std::size_t before = allocations();
      network_->receive(clock_.now());
      network_->send(clock_.now());
      ASSERT_EQ(allocations(), before) << "the loop must not allocate";
      clock_.sleep_until(clock_.now() + 10ms);
    }
    network_->receive(clock_.now());
  }
  Drive& drive(std::size_t i = 0) { return *network_->drives()[i]; }
  DriveState state(std::size_t i = 0) { return drive(i).feedback().state; }
  void ask(DriveRequest what, int cycles = 20) {
    drive().request(what);
    run(cycles);
  }
  void start_enabled(const Options& options = {}) {
    shoulder_.state |= kHomeOk;
    start(options);
    ask(DriveRequest::enable);
    ASSERT_EQ(state(), DriveState::enabled) << drive().feedback().fault;
  }

  SteppedClock clock_;
  InProcessBus bus_;
  std::unique_ptr<CanBus> end_;
  ScriptedModule shoulder_, elbow_;
  std::unique_ptr<Network> network_;
};

template <typename Error, typename Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "(no error)";
}

TEST_F(PowerCube, ScanFindsWhatAnswers) {
  elbow_.values[Param::config] = kConfigLinear;
  const auto found = scan(*end_, clock_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].id, 3);
  EXPECT_EQ(found[0].serial, 1003u);
  EXPECT_EQ(found[1].version, 0x3512);
  EXPECT_FALSE(found[0].linear);
  EXPECT_TRUE(found[1].linear);
}

TEST_F(PowerCube, RefusesAnotherModule) {
  DriveConfig config = joint("shoulder", 3);
  config.serial = 7;
  const auto said = message_of<InputError>([&] { start({}, {config}); });
  EXPECT_THAT(said, testing::AllOf(HasSubstr("module 3 (shoulder)"), HasSubstr("1003"), HasSubstr("7")));
}

TEST_F(PowerCube, SaysWhoDoesNotAnswer) {
  const auto said = message_of<RuntimeFailure>([&] { start({}, {joint("wrist", 9)}); });
  EXPECT_THAT(said, testing::AllOf(HasSubstr("module 9 (wrist)"), HasSubstr("can0"), HasSubstr("DefCubeSerial")));
}

TEST_F(PowerCube, RefusesLimitsOutsideOfTheModules) {
  DriveConfig config = joint("shoulder", 3);
  config.max_position = 2.5;
  EXPECT_THAT(message_of<InputError>([&] { start({}, {config}); }), HasSubstr("2.5"));
  config = joint("shoulder", 3);
  config.max_velocity = 4;
  EXPECT_THAT(message_of<InputError>([&] { start({}, {config}); }), HasSubstr("max_velocity 4"));
}

TEST_F(PowerCube, RefusesBadRigs) {
  EXPECT_THAT(message_of<InputError>([&] { start({}, {joint("a", 3), joint("b", 3)}); }), HasSubstr("'a' and 'b'"));
  EXPECT_THAT(message_of<InputError>([&] { start({}, {joint("a", 32)}); }), HasSubstr("node"));
  EXPECT_THAT(message_of<InputError>([&] { start({.cycle = 50ms}); }), HasSubstr("cycle"));
}

TEST_F(PowerCube, WritesLimitsAndWatchdogInTheModulesDirection) {
  DriveConfig config = joint("shoulder", 3);
  config.direction = -1;
  config.offset = 0.5;
  start({}, {config});
  EXPECT_EQ(shoulder_.values[Param::min_pos], -1);   // -(1.5 - 0.5)
  EXPECT_EQ(shoulder_.values[Param::max_pos], 1.5);  // -(-1 - 0.5)
  EXPECT_EQ(shoulder_.values[Param::max_vel], 2);
  EXPECT_NEAR(shoulder_.values[Param::def_home_vel], -0.05, 1e-6) << "keeps its direction";
  EXPECT_EQ(shoulder_.values[Param::config], kConfigWatchdog | 0x11);
  EXPECT_NEAR(drive().feedback().position, 0.5 - 0.25, 1e-6);
}

TEST_F(PowerCube, WithoutProvenWatchdogCannotBeEnabled) {
  shoulder_.state |= kHomeOk;
  shoulder_.read_only = {Param::config};
  EXPECT_THAT(message_of<RuntimeFailure>([&] { start(); }), HasSubstr("Config"));
  run(5);
  ask(DriveRequest::enable);
  EXPECT_EQ(state(), DriveState::disabled);
  EXPECT_EQ(shoulder_.resets, 0);
}

TEST_F(PowerCube, EnablesWhereItStandsAndSteps) {
  start_enabled();
  EXPECT_THAT(shoulder_.steps, Each(0.25)) << "holds";
  EXPECT_EQ(state(1), DriveState::disabled);
  drive().set_point(0.26, 0);
  run(3);
  EXPECT_FLOAT_EQ(static_cast<float>(shoulder_.position), 0.26f);
  EXPECT_TRUE(drive().feedback().target_reached);
  EXPECT_NEAR(drive().feedback().position, 0.26, 1e-6);
  EXPECT_TRUE(elbow_.steps.empty());
}

TEST_F(PowerCube, StepsStayWithinLimitsAndVelocity) {
  start_enabled();
  drive().set_point(9, 0);
  run(200);
  EXPECT_FLOAT_EQ(static_cast<float>(shoulder_.position), 1.5f);
  for (std::size_t i = 1; i < shoulder_.steps.size(); ++i)
    EXPECT_LE(shoulder_.steps[i] - shoulder_.steps[i - 1], 2 * 0.010 + 1e-6);
  drive().set_point(std::nan(""), 0);
  run(5);
  EXPECT_FLOAT_EQ(static_cast<float>(shoulder_.position), 1.5f) << "not a number: holds";
}

TEST_F(PowerCube, RampsOnlyWhenTheSetPointChanges) {
  start_enabled({.set_points = SetPoints::ramp});
  EXPECT_TRUE(shoulder_.ramps.empty());
  drive().set_point(0.75, 0);
  run(100);
  EXPECT_THAT(shoulder_.ramps, testing::ElementsAre(0.75));
  EXPECT_TRUE(shoulder_.steps.empty());
  EXPECT_TRUE(drive().feedback().target_reached);
}

TEST_F(PowerCube, FeedsTheWatchdogEvery40ms) {
  start();
  run(100);
  ASSERT_GT(shoulder_.refreshes.size(), 20u);
  for (std::size_t i = 1; i < shoulder_.refreshes.size(); ++i)
    EXPECT_LE(shoulder_.refreshes[i] - shoulder_.refreshes[i - 1], 40ms);
}

TEST_F(PowerCube, TheWatchdogStopsItWhenWeFallSilent) {
  start_enabled();
  clock_.sleep_until(clock_.now() + 100ms);
  EXPECT_TRUE(shoulder_.state & kHalted);
  run(10);
  EXPECT_NE(state(), DriveState::enabled);
}

TEST_F(PowerCube, HomesOnlyWhenAsked) {
  start();
  ask(DriveRequest::home);
  EXPECT_EQ(shoulder_.homes, 0) << "not while disabled";
  ask(DriveRequest::enable);
  ASSERT_EQ(state(), DriveState::enabled);
  drive().set_point(0.5, 0);
  run(10);
  EXPECT_TRUE(shoulder_.steps.empty()) << "not homed: no set-points";
  ask(DriveRequest::home, 5);
  EXPECT_EQ(state(), DriveState::homing);
  run(40);
  EXPECT_EQ(state(), DriveState::enabled);
  EXPECT_EQ(shoulder_.homes, 1);
  EXPECT_TRUE(drive().feedback().homed);
  EXPECT_FALSE(shoulder_.steps.empty());
  EXPECT_THAT(shoulder_.steps, Each(0.0)) << "holds where homing ended";
}

TEST_F(PowerCube, OneThatStandsAtHomeMayBeDoneBetweenTwoStateWords) {
  shoulder_.homing_takes = Duration{0};
  start();
  shoulder_.state |= kHomeOk;
  ask(DriveRequest::enable);
  ASSERT_EQ(state(), DriveState::enabled);
  ask(DriveRequest::home, 5);
  run(400);
  EXPECT_EQ(shoulder_.homes, 1);
  EXPECT_EQ(state(), DriveState::enabled) << drive().feedback().fault;
}

TEST_F(PowerCube, HomingWithoutEndFails) {
  shoulder_.never_ends_homing = true;
  start();
  ask(DriveRequest::enable);
  ask(DriveRequest::home, 12'000);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_THAT(drive().feedback().fault, HasSubstr("homing"));
  EXPECT_TRUE(shoulder_.state & kHalted);
}

TEST_F(PowerCube, QuickStopHalts) {
  start_enabled();
  drive().set_point(1, 0);
  run(2);
  drive().request(DriveRequest::quick_stop);
  drive().request(DriveRequest::enable);
  const auto steps = shoulder_.steps.size();
  run(10);
  EXPECT_EQ(state(), DriveState::disabled);
  EXPECT_TRUE(shoulder_.state & kHalted);
  EXPECT_EQ(shoulder_.steps.size(), steps);
}

TEST_F(PowerCube, FaultsAreNamedAndNothingOldIsSentAfterwards) {
  start_enabled();
  drive().set_point(0.9, 0);
  run(10);
  const double stood = shoulder_.position;
  shoulder_.state |= kError | 0x10;
  run(10);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_STREQ(drive().feedback().fault, "following error");
  ask(DriveRequest::enable);
  EXPECT_EQ(state(), DriveState::fault) << "first reset_fault";
  ask(DriveRequest::reset_fault);
  EXPECT_EQ(state(), DriveState::disabled);
  shoulder_.steps.clear();
  ask(DriveRequest::enable);
  EXPECT_EQ(state(), DriveState::enabled);
  EXPECT_FALSE(shoulder_.steps.empty());
  EXPECT_THAT(shoulder_.steps, Each(testing::DoubleNear(stood, 1e-6)));
}

TEST_F(PowerCube, SilentModulesAreOfflineAndComeBackHalted) {
  start_enabled();
  drive().set_point(0.9, 0);
  run(10);
  shoulder_.silent = true;
  run(10);
  EXPECT_EQ(state(), DriveState::offline);
  EXPECT_STREQ(drive().feedback().fault, "does not answer");
  shoulder_.silent = false;
  shoulder_.position = -0.3;
  shoulder_.steps.clear();
  run(20);
  EXPECT_EQ(state(), DriveState::disabled);
  EXPECT_TRUE(shoulder_.steps.empty());
  ask(DriveRequest::enable);
  EXPECT_EQ(state(), DriveState::enabled);
  EXPECT_THAT(shoulder_.steps, Each(testing::DoubleNear(-0.3, 1e-6)));
}

TEST_F(PowerCube, ALoopThatIsLateDoesNotTakeModulesForSilent) {
  start_enabled({.missing_cycles = 1});
  for (int i = 0; i < 5; ++i) {
    clock_.sleep_until(clock_.now() + 15ms);  // a cycle and a half, besides its own; within the modules' own patience
    run(3);
    ASSERT_EQ(state(), DriveState::enabled) << drive().feedback().fault;
  }
  shoulder_.silent = true;
  run(3);
  EXPECT_EQ(state(), DriveState::offline) << "one that was asked in vain is missed all the same";
}

// Late by 24 ms, however long after it fed them.
TEST_F(PowerCube, ALoopThatIsLateLetsNoWatchdogRunOut) {
  start_enabled({.cycle = 4ms});
  const auto cycle = [&] {
    network_->receive(clock_.now());
    network_->send(clock_.now());
    clock_.sleep_until(clock_.now() + 4ms);
  };
  for (int cycles = 0; cycles < 10; ++cycles) {
    for (const std::size_t fed = shoulder_.refreshes.size(); shoulder_.refreshes.size() == fed;) cycle();
    for (int i = 0; i < cycles; ++i) cycle();
    clock_.sleep_until(clock_.now() + 24ms);
    ASSERT_FALSE(shoulder_.state & kHalted) << "late " << cycles << " cycles after";
  }
}

TEST_F(PowerCube, AModuleThatLostItsPowerMustBeConfiguredAgain) {
  start_enabled();
  shoulder_.silent = true;
  run(10);
  shoulder_.lose_power();
  shoulder_.silent = false;
  run(20);
  ask(DriveRequest::enable);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_THAT(drive().feedback().fault, HasSubstr("configure"));
  EXPECT_TRUE(shoulder_.state & kHalted);
  drive().configure();
  ask(DriveRequest::reset_fault);
  ask(DriveRequest::enable);
  EXPECT_EQ(state(), DriveState::enabled);
}

TEST_F(PowerCube, EnablingGivesUp) {
  shoulder_.deaf_to_reset = true;
  start();
  ask(DriveRequest::enable, 120);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_STREQ(drive().feedback().fault, "does not leave its halt");
}

TEST_F(PowerCube, AnotherMasterStopsAll) {
  start_enabled();
  EXPECT_TRUE(network_->healthy());
  bus_.attach()->send(command(4, Command::reset));
  run(10);
  EXPECT_FALSE(network_->healthy());
  EXPECT_THAT(network_->reason(), HasSubstr("another master"));
  EXPECT_EQ(state(), DriveState::disabled);
  ask(DriveRequest::enable);
  EXPECT_EQ(state(), DriveState::disabled);
}

TEST_F(PowerCube, TheAllocationCounterCounts) {
  const std::size_t before = allocations();
  ::operator delete(::operator new(1));  // a plain new could be optimised away
  EXPECT_GT(allocations(), before);
}

/// A bus whose transmit queue is full, or that is off, while `refuses` says so.
class RefusingBus final : public CanBus {
 public:
  explicit RefusingBus(CanBus& bus) : bus_(bus) {}
  CanSend refuses = CanSend::sent;

  const std::string& name() const noexcept override { return bus_.name(); }
  CanSend send(const CanFrame& frame) noexcept override {
    return refuses == CanSend::sent ? bus_.send(frame) : refuses;
  }
  std::optional<CanFrame> receive(Duration timeout) noexcept override { return bus_.receive(timeout); }
  CanBusState state() const noexcept override {
    return refuses == CanSend::bus_down ? CanBusState::bus_off : CanBusState::active;
  }
  CanCounters counters() const noexcept override { return bus_.counters(); }

 private:
  CanBus& bus_;
};

TEST_F(PowerCube, ABusThatWasOffLeavesAllHalted) {
  shoulder_.state |= kHomeOk;
  auto bus = std::make_unique<RefusingBus>(*end_);
  RefusingBus& refusing = *bus;
  network_ = std::make_unique<Network>(refusing, clock_, std::vector{joint("shoulder", 3)});
  drive().identify();
  drive().configure();
  run(10);
  ask(DriveRequest::enable);
  ASSERT_EQ(state(), DriveState::enabled);
  drive().set_point(1, 0);
  run(5);
  refusing.refuses = CanSend::bus_down;
  run(20);
  EXPECT_FALSE(network_->healthy());
  EXPECT_EQ(state(), DriveState::offline);
  EXPECT_TRUE(shoulder_.state & kHalted) << "by its watchdog";
  const double stood = shoulder_.position;
  refusing.refuses = CanSend::sent;
  shoulder_.steps.clear();
  run(20);
  EXPECT_TRUE(network_->healthy());
  EXPECT_EQ(state(), DriveState::disabled);
  EXPECT_TRUE(shoulder_.steps.empty());
  EXPECT_EQ(shoulder_.position, stood);
  refusing.refuses = CanSend::full;
  EXPECT_THAT(message_of<RuntimeFailure>([&] { drive().identify(); }), HasSubstr("transmit queue is full"));
  network_.reset();
}

TEST_F(PowerCube, RandomFramesChangeNoSetPoint) {
  start_enabled();
  drive().set_point(0.3, 0);
  run(10);
  shoulder_.steps.clear();
  std::mt19937 random(7);
  const auto stranger = bus_.attach();
  int enabled = 0;
  for (int i = 0; i < 10'000; ++i) {
    CanFrame frame;
    // Half of them look like answers of the modules; some begin like a value or a motion.
    frame.id = i % 2 == 0 ? 0x0A3 + random() % 2 : random() % 0x800;
    if (frame.id >= 0x0C0 && frame.id <= 0x100) frame.id = 0x0A0;  // commands would be another master
    frame.size = static_cast<std::uint8_t>(random() % 9);
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    if (i % 4 == 0) frame.data[0] = static_cast<std::uint8_t>(0x08 + random() % 6);
    stranger->send(frame);
    run(1);
    if (state() == DriveState::enabled) ++enabled;
    if (state() == DriveState::fault) drive().request(DriveRequest::reset_fault);
    if (state() == DriveState::disabled) drive().request(DriveRequest::enable);
  }
  EXPECT_GT(enabled, 5'000);
  EXPECT_GT(shoulder_.steps.size(), 5'000u);
  EXPECT_THAT(shoulder_.steps, Each(testing::DoubleNear(0.3, 1e-6)));
}

}  // namespace
}  // namespace foresight::powercube::network_test
