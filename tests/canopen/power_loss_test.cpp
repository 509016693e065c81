// Where a drive with an incremental encoder may have lost its supply, the joint's zero is gone: it must not be told as
// homed. Where it provably has not, it keeps its zero. Emulated drives that share no code with the master.
#include <gmock/gmock.h>

#include <cmath>

#include "common/error.hpp"
#include "drivers/can/in_process_bus.hpp"
#include "drivers/canopen/canopen_network.hpp"
#include "sim/drives/drive_rack.hpp"

namespace foresight::canopen::power_loss_test {
namespace {

using namespace std::chrono_literals;
using sim::DriveFault;
using testing::Contains;
using testing::HasSubstr;

constexpr int kNode = 4, kHomeIsHere = 37;  // 6098h
constexpr double kCountsPerUnit = 100'000;
constexpr double kMoved = -0.8, kSpeed = 0.5;  // where the tests begin, and how fast the joint goes there
constexpr double kServoError = 1e-3;           // of the emulated shaft at rest
constexpr std::size_t kElbow = 0;              // in the rack
constexpr const char* kLeftOperational = "left the state 'operational'";  // as 1029h has it once 1016h found us silent

sim::NodeConfig emulated(bool absolute) {
  sim::NodeConfig out;
  out.node = kNode;
  out.name = "elbow";
  out.counts_per_unit = kCountsPerUnit;
  out.homed = absolute;
  out.hold_when_missed = true;  // only its watchdog stops it where we fall silent
  return out;
}

Cia402Config joint(bool absolute) {
  Cia402Config out;
  out.drive.name = "elbow";
  out.drive.node = kNode;
  out.drive.counts_per_unit = kCountsPerUnit;
  out.drive.min_position = -3;
  out.drive.max_position = 3;
  out.drive.max_velocity = 1;
  out.drive.max_acceleration = 5;
  out.homing_method = kHomeIsHere;
  out.absolute_encoder = absolute;
  return out;
}

/// A joint with its master in stepped time: homed, then moved, and at rest there.
class Elbow {
 public:
  explicit Elbow(bool absolute = false) : rack(clock, bus.attach(), {emulated(absolute)}) {
    network.emplace(*master, clock, config, std::vector{joint(absolute)});
    clock.every(1ms, [this](RobotTime now) {
      if (!restart_at || now < *restart_at) return;
      inject(DriveFault::reset);
      restart_at.reset();
    });
    set_up();
    enable();
    drive().request(DriveRequest::home);
    cycles(500ms);
    const double step = kSpeed * to_seconds(config.cycle);
    for (double to = 0; to > kMoved; to -= step) cycles(config.cycle, to);
    cycles(500ms, kMoved);
  }
  Drive& drive() { return *network->drives()[0]; }
  DriveFeedback feedback() { return drive().feedback(); }
  double truth() const { return rack.shaft(kElbow).position; }
  /// As RobotDevices::bring_up() does it.
  void set_up() {
    drive().identify();
    drive().configure();
  }
  void enable() {
    drive().request(DriveRequest::enable);
    cycles(500ms);
  }
  void cycles(Duration time, std::optional<double> position = std::nullopt) {
    for (const RobotTime until = clock.now() + time; clock.now() < until;) {
      network->receive(clock.now());
      if (position) drive().set_point(*position, 0);
      network->send(clock.now());
      clock.sleep_until(clock.now() + config.cycle);
    }
    network->receive(clock.now());
  }
  /// The control loop stands still.
  void pause(Duration time) { clock.sleep_until(clock.now() + time); }
  void inject(DriveFault fault) { rack.inject(kElbow, fault); }
  void switch_off_and_on() {
    inject(DriveFault::no_power);
    cycles(500ms);
    inject(DriveFault::recover);
    cycles(500ms);
  }

  SteppedClock clock;
  InProcessBus bus{"can0", clock, {.wire = {}, .faults = {.recovery = 0ms}}};  // bus-off lasts until restart()
  sim::DriveRack rack;
  std::unique_ptr<CanBus> master = bus.attach();
  NetworkConfig config;
  std::optional<CanopenNetwork> network;
  std::optional<RobotTime> restart_at;  // of the drive, once
};

struct PowerLoss : testing::Test {
  Elbow elbow;
  void SetUp() override {
    ASSERT_EQ(elbow.feedback().state, DriveState::enabled) << elbow.feedback().fault;
    expect_zero_kept();
  }
  void expect_zero_kept() {
    EXPECT_TRUE(elbow.feedback().homed);
    EXPECT_STREQ(elbow.feedback().fault, "");
    EXPECT_NEAR(elbow.feedback().position, elbow.truth(), kServoError);
    EXPECT_NEAR(elbow.truth(), kMoved, 0.01);
  }
  void expect_zero_lost(const char* why) {
    EXPECT_FALSE(elbow.feedback().homed) << "told " << elbow.feedback().position << ", truth " << elbow.truth();
    EXPECT_THAT(elbow.feedback().fault, HasSubstr(why));
    EXPECT_THAT(elbow.feedback().fault, HasSubstr("home it"));
    EXPECT_THAT(elbow.drive().remarks(), Contains(HasSubstr(why))) << "set-up says it too";
  }
};

// Object 1029h: it leaves "operational" where our heartbeat is late. The boot-up message comes when it is not set up.
TEST_F(PowerLoss, AfterItLeftOperational) {
  elbow.pause(500ms);
  elbow.cycles(200ms);
  ASSERT_THAT(elbow.feedback().fault, HasSubstr(kLeftOperational));
  EXPECT_TRUE(elbow.feedback().homed) << "until it is switched off";
  elbow.switch_off_and_on();
  EXPECT_FALSE(elbow.feedback().homed);
  EXPECT_THAT(elbow.feedback().fault, HasSubstr("restarted"));
  elbow.set_up();
  elbow.cycles(100ms);
  expect_zero_lost("restarted");
  elbow.enable();
  EXPECT_EQ(elbow.feedback().state, DriveState::enabled) << "it can be homed";
  elbow.drive().request(DriveRequest::home);
  elbow.cycles(500ms);
  EXPECT_TRUE(elbow.feedback().homed);
  EXPECT_STREQ(elbow.feedback().fault, "");
  elbow.set_up();
  EXPECT_THAT(elbow.drive().remarks(), testing::Not(Contains(HasSubstr("home it"))));
}

// Nobody hears its boot-up message.
TEST_F(PowerLoss, WhileTheBusIsOff) {
  elbow.bus.force_bus_off(*elbow.master);
  elbow.cycles(200ms);
  elbow.switch_off_and_on();
  elbow.bus.restart(*elbow.master);
  elbow.cycles(1s);
  EXPECT_FALSE(elbow.feedback().homed);
  elbow.set_up();
  elbow.cycles(100ms);
  expect_zero_lost("silent");
}

TEST_F(PowerLoss, WhileTheBusIsOffAndTheLoopStandsStill) {
  elbow.bus.force_bus_off(*elbow.master);
  elbow.inject(DriveFault::no_power);
  elbow.pause(500ms);
  elbow.inject(DriveFault::recover);
  elbow.pause(500ms);
  elbow.bus.restart(*elbow.master);
  elbow.set_up();
  elbow.cycles(100ms);
  expect_zero_lost("silent");
}

TEST_F(PowerLoss, WhileASetUpFails) {
  elbow.inject(DriveFault::no_power);
  EXPECT_THROW(elbow.set_up(), RuntimeFailure);
  elbow.inject(DriveFault::recover);
  elbow.pause(500ms);
  elbow.set_up();
  elbow.cycles(100ms);
  expect_zero_lost("restarted");
}

/// Restarts the drive so much time into its set-up, where that takes as long. What set-up threw.
std::string restart_in_set_up(Elbow& elbow, Duration after) {
  elbow.restart_at = elbow.clock.now() + after;
  try {
    elbow.set_up();
  } catch (const std::exception& failure) {
    return failure.what();
  }
  return "";
}

/// Our silence stops it, by its own decision: the watchdog is what set-up wrote into it.
void expect_watchdog(Elbow& elbow, Duration after) {
  elbow.enable();
  ASSERT_EQ(elbow.feedback().state, DriveState::enabled) << after.count() << " ns: " << elbow.feedback().fault;
  elbow.pause(500ms);
  elbow.network->receive(elbow.clock.now());
  EXPECT_THAT(elbow.feedback().fault, HasSubstr(kLeftOperational)) << after.count() << " ns";
}

TEST(PowerLossInSetUp, FailsItOrComesBeforeIt) {
  int failed = 0;
  Duration after = 0ms;
  for (;; after += 1ms) {
    Elbow elbow;
    const std::string error = restart_in_set_up(elbow, after);
    if (elbow.restart_at) break;
    elbow.cycles(100ms);
    EXPECT_FALSE(elbow.feedback().homed) << after.count() << " ns: " << error;
    if (!error.empty()) {
      ++failed;
      EXPECT_THAT(error, HasSubstr("elbow (node 4 on can0) restarted during its set-up"));
    }
    // It has failed, or the boot-up message came just behind it; else it came before, and all is written.
    if (elbow.feedback().state != DriveState::disabled) elbow.set_up();
    elbow.cycles(100ms);
    EXPECT_THAT(elbow.feedback().fault, HasSubstr("restarted and has lost its zero"));
    expect_watchdog(elbow, after);
  }
  EXPECT_GT(failed, 10);
  EXPECT_LT(failed * 1ms, after) << "before the first value is written there is nothing to lose";
}

TEST(PowerLossOfAbsoluteEncoders, KeepsTheZero) {
  Elbow elbow(true);
  elbow.switch_off_and_on();
  elbow.set_up();
  elbow.cycles(100ms);
  EXPECT_TRUE(elbow.feedback().homed);
  EXPECT_STREQ(elbow.feedback().fault, "");
  EXPECT_NEAR(elbow.feedback().position, elbow.truth(), kServoError);
}

struct PowerKept : PowerLoss {};

TEST_F(PowerKept, ByADriveThatLeftOperational) {
  elbow.pause(1500ms);
  elbow.cycles(200ms);
  ASSERT_THAT(elbow.feedback().fault, HasSubstr(kLeftOperational));
  elbow.set_up();
  elbow.cycles(100ms);
  expect_zero_kept();
}

TEST_F(PowerKept, ByADriveThatIsSetUpAgain) {
  elbow.drive().request(DriveRequest::disable);
  elbow.cycles(500ms);
  elbow.set_up();
  elbow.cycles(100ms);
  expect_zero_kept();
}

TEST_F(PowerKept, ByADriveThatIsSilentForAMoment) {
  elbow.inject(DriveFault::silent);
  elbow.cycles(elbow.config.drive_heartbeat);
  elbow.inject(DriveFault::recover);
  elbow.cycles(500ms);
  EXPECT_TRUE(elbow.feedback().homed);
}

// It kept its power, but nobody can know.
TEST_F(PowerLoss, IsAssumedOfADriveThatWasSilent) {
  elbow.inject(DriveFault::silent);
  elbow.cycles(500ms);
  EXPECT_STREQ(elbow.feedback().fault, "the drive is silent");
  elbow.inject(DriveFault::recover);
  elbow.cycles(500ms);
  EXPECT_FALSE(elbow.feedback().homed);
  EXPECT_THAT(elbow.feedback().fault, HasSubstr("silent"));
  EXPECT_THAT(elbow.feedback().fault, HasSubstr("home it"));
  elbow.set_up();
  elbow.cycles(100ms);
  expect_zero_lost("silent");
}

}  // namespace
}  // namespace foresight::canopen::power_loss_test
