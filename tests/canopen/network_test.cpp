#include <gmock/gmock.h>

#include "drivers/canopen/nmt.hpp"
#include "frames.hpp"
#include "scripted_slave.hpp"

namespace foresight::canopen::network_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// Commands of the slave that put it, or keep it, in operation: the targets that count.
std::vector<std::int32_t> followed(const ScriptedSlave& s, std::size_t from = 0) {
  std::vector<std::int32_t> out;
  for (std::size_t i = from; i < s.commands.size(); ++i)
    if ((s.commands[i].word & 0x0f) == 0x0f) out.push_back(s.commands[i].target);
  return out;
}

struct Network : testing::Test {
  CanopenRig rig;
  ScriptedSlave& slave = rig.slave();
  void SetUp() override {
    rig.configure();
    rig.enable();
    ASSERT_EQ(rig.feedback().state, DriveState::enabled);
  }
};

TEST_F(Network, EnablesAtTheActualPosition) {
  for (const std::int32_t target : followed(slave)) EXPECT_EQ(target, 1000);
  EXPECT_EQ(slave.position, 1000);
  EXPECT_DOUBLE_EQ(rig.feedback().position, 1.5);
}

TEST_F(Network, FollowsSetPointsInJointUnits) {
  rig.cycles(3, 2.25);
  EXPECT_EQ(slave.position, 1750);
  EXPECT_DOUBLE_EQ(rig.feedback().position, 2.25);
  EXPECT_EQ(rig.feedback().time, rig.clock.now() - (rig.config.cycle - 1ms)) << "the instant of its frame";
  rig.cycles(3, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(slave.position, 1750) << "holds";
  rig.cycles(3, 99.0);
  EXPECT_EQ(slave.position, 9500) << "the limit";
}

TEST_F(Network, AJointOutsideOfItsLimitsIsNotThrownBack) {
  rig.drive().request(DriveRequest::disable);
  rig.cycles(5);
  slave.position = 12000;  // 12.5, and the limit is 10
  rig.cycles(2);
  rig.enable();
  rig.cycles(3, 12.5);
  EXPECT_EQ(slave.position, 12000);
  rig.cycles(3, 13.0);
  EXPECT_EQ(slave.position, 12000);
  rig.cycles(3, 11.0);
  rig.cycles(3, 11.5);
  EXPECT_EQ(slave.position, 10500) << "no way back out";
}

TEST(NetworkDrives, EachHasItsOwnDirection) {
  CanopenRig rig(3);
  rig.configure();
  rig.enable();
  rig.cycles(3, 1.0);
  EXPECT_EQ(rig.slave(0).position, 500);
  EXPECT_EQ(rig.slave(1).position, -500);
  EXPECT_EQ(rig.slave(2).position, 500);
  EXPECT_DOUBLE_EQ(rig.feedback(1).position, 1.0);
}

TEST_F(Network, SendsSyncEachCycleAndTheHeartbeatOnTime) {
  slave.syncs = slave.heartbeats_heard = 0;
  rig.cycles(100);
  EXPECT_EQ(slave.syncs, 100);
  EXPECT_EQ(slave.heartbeats_heard, 50) << "every 20 ms";
}

TEST_F(Network, DisablesAndStops) {
  rig.drive().request(DriveRequest::quick_stop);
  rig.drive().request(DriveRequest::enable);
  rig.cycles(5, 3.0);
  EXPECT_EQ(slave.state, 0x07);
  EXPECT_EQ(rig.feedback().state, DriveState::stopping);
  EXPECT_EQ(slave.position, 1000);
  rig.enable();
  EXPECT_EQ(rig.feedback().state, DriveState::enabled);
  EXPECT_EQ(slave.position, 1000);
  rig.drive().request(DriveRequest::disable);
  rig.cycles(5, 3.0);
  EXPECT_EQ(slave.state, 0x40);
  EXPECT_EQ(rig.feedback().state, DriveState::disabled);
}

TEST_F(Network, FaultResetAndEnableStartWhereTheJointIs) {
  rig.cycles(3, 5.0);
  slave.fail(0x8611);
  rig.cycles(3, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::fault);
  EXPECT_EQ(rig.feedback().fault_code, 0x8611u);
  EXPECT_STREQ(rig.feedback().fault, "following error");
  slave.position = 200;  // it sank
  rig.drive().request(DriveRequest::enable);
  rig.cycles(5, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::fault);
  const std::size_t before = slave.commands.size();
  rig.drive().request(DriveRequest::reset_fault);
  rig.cycles(12, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::disabled);
  EXPECT_TRUE(followed(slave, before).empty()) << "a reset is no enabling";
  rig.enable();
  EXPECT_EQ(rig.feedback().state, DriveState::enabled);
  EXPECT_FALSE(followed(slave, before).empty());
  for (const std::int32_t target : followed(slave, before)) EXPECT_EQ(target, 200);
}

TEST_F(Network, AnEmergencyMessageAloneStops) {
  slave.send(0x080, {0x10, 0x43, 0x08, 0, 0, 0, 0, 0});
  rig.cycles(4, 5.0);
  EXPECT_EQ(slave.state, 0x07);
  EXPECT_EQ(rig.feedback().state, DriveState::fault);
  EXPECT_STREQ(rig.feedback().fault, "excess temperature of the drive");
  slave.send(0x080, {0, 0, 0, 0, 0, 0, 0, 0});
  rig.cycles(4, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::stopping) << "withdrawn, but nobody asked for more";
  EXPECT_EQ(slave.position, 1000);
}

TEST_F(Network, SilenceIsOfflineAndReturnIsNoEnabling) {
  rig.cycles(3, 5.0);
  EXPECT_EQ(slave.position, 4500);
  slave.mute = true;
  rig.cycles(20, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::offline);
  slave.mute = false;
  slave.position = 300;
  const std::size_t before = slave.commands.size();
  rig.cycles(20, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::stopping);
  EXPECT_TRUE(followed(slave, before).empty());
  rig.enable();
  EXPECT_EQ(rig.feedback().state, DriveState::enabled);
  for (const std::int32_t target : followed(slave, before)) EXPECT_EQ(target, 300);
}

TEST_F(Network, LostProcessDataIsALossToo) {
  slave.sends_pdos = false;
  rig.cycles(20, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::offline);
  EXPECT_EQ(slave.state, 0x07);
  rig.drive().request(DriveRequest::enable);
  rig.cycles(5, 5.0);
  slave.sends_pdos = true;
  rig.cycles(10, 5.0);
  EXPECT_EQ(slave.state, 0x07) << "a request while offline is dropped, not kept";
}

TEST_F(Network, ARestartedNodeNeedsSetUp) {
  rig.cycles(3, 5.0);
  slave.reboot();
  rig.cycles(2, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::fault);
  EXPECT_THAT(rig.feedback().fault, HasSubstr("restarted"));
  slave.nmt = 5;  // even were it operational, it gets nothing
  slave.commands.clear();
  rig.drive().request(DriveRequest::enable);
  rig.cycles(20, 5.0);
  EXPECT_TRUE(slave.commands.empty());
  slave.position = -700;
  rig.drive().configure();
  rig.cycles(3, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::disabled);
  rig.enable();
  EXPECT_EQ(rig.feedback().state, DriveState::enabled);
  for (const std::int32_t target : followed(slave)) EXPECT_EQ(target, -700);
}

TEST_F(Network, LeavingOperationalNeedsSetUp) {
  slave.nmt = 0x7f;
  rig.cycles(10, 5.0);
  EXPECT_EQ(rig.feedback().state, DriveState::fault);
  EXPECT_THAT(rig.feedback().fault, HasSubstr("operational"));
}

TEST(NetworkMasters, AnotherOneEndsEnabling) {
  for (const char* text : {"000#0101", "080#", "77F#05", "201#0F0000000000", "601#4000100000000000"}) {
    CanopenRig rig;
    rig.configure();
    rig.enable();
    rig.cycles(3, 2.0);
    ASSERT_TRUE(rig.network->healthy());
    rig.stranger->send(frame(text));
    rig.cycles(4, 5.0);
    EXPECT_FALSE(rig.network->healthy()) << text;
    EXPECT_STRNE(rig.network->reason(), "");
    EXPECT_EQ(rig.slave().state, 0x07) << text;
    rig.enable();
    EXPECT_NE(rig.feedback().state, DriveState::enabled) << text;
  }
}

TEST(NetworkMasters, OtherNodesAreNone) {
  CanopenRig rig;
  rig.configure();
  rig.enable();
  for (const char* text : {"705#05", "185#0000", "205#0F00", "605#4000100000000000", "100#000000000000"})
    rig.stranger->send(frame(text));
  CanFrame remote = frame("701#");
  remote.remote = true;
  rig.stranger->send(remote);
  rig.cycles(4, 2.0);
  EXPECT_TRUE(rig.network->healthy()) << rig.network->reason();
  EXPECT_EQ(rig.slave().position, 1500);
}

TEST_F(Network, HomesOnRequestAndHoldsThere) {
  rig.cycles(3, 3.0);
  EXPECT_FALSE(rig.feedback().homed);
  rig.drive().request(DriveRequest::home);
  rig.cycles(15, 3.0);
  EXPECT_EQ(rig.feedback().state, DriveState::homing);
  EXPECT_EQ(slave.object(0x6060).value, 6u);
  rig.cycles(60);
  EXPECT_TRUE(rig.feedback().homed);
  EXPECT_EQ(rig.feedback().state, DriveState::enabled);
  EXPECT_EQ(slave.object(0x6060).value, 8u);
  EXPECT_EQ(slave.position, 0) << "and not where it was before";
  rig.cycles(3, 1.0);
  EXPECT_EQ(slave.position, 500);
}

TEST_F(Network, FailedHomingStops) {
  slave.homing_fails = true;
  rig.drive().request(DriveRequest::home);
  rig.cycles(60);
  EXPECT_FALSE(rig.feedback().homed);
  EXPECT_EQ(rig.feedback().state, DriveState::stopping);
  EXPECT_THAT(rig.feedback().fault, HasSubstr("homing failed"));
}

TEST_F(Network, ARefusedModeStops) {
  slave.remove(0x6060);
  rig.drive().request(DriveRequest::home);
  rig.cycles(10, 3.0);
  EXPECT_EQ(rig.feedback().state, DriveState::stopping);
  EXPECT_STREQ(rig.feedback().fault, "the drive refused its mode of operation");
  rig.enable();
  EXPECT_EQ(rig.feedback().state, DriveState::stopping);
}

TEST(NetworkFaults, ADriveThatIsInFaultAtSetUpCanBeReset) {
  CanopenRig rig;
  rig.slave().state = 0x08;
  rig.slave().remove(0x603F);
  rig.configure();
  rig.cycles(3);
  EXPECT_EQ(rig.feedback().state, DriveState::fault);
  EXPECT_STREQ(rig.feedback().fault, "the drive does not say why");
  rig.drive().request(DriveRequest::reset_fault);
  rig.cycles(12);
  rig.enable();
  EXPECT_EQ(rig.feedback().state, DriveState::enabled);
}

TEST(NetworkFaults, AFaultThatRemainsIsSaid) {
  CanopenRig rig;
  rig.configure();
  rig.enable();
  rig.slave().stuck_fault = true;
  rig.slave().fail(0x7121);
  rig.cycles(3);
  rig.drive().request(DriveRequest::reset_fault);
  rig.cycles(40);
  EXPECT_EQ(rig.feedback().state, DriveState::fault);
  EXPECT_EQ(rig.feedback().fault_code, 0x7121u);
}

TEST(NetworkModes, CyclicVelocityStartsAndStopsAtZero) {
  CanopenRig rig(1, OperationMode::cyclic_velocity);
  rig.configure();
  EXPECT_EQ(rig.slave().object(0x1600, 2).value, 0x60FF0020u);
  rig.enable();
  EXPECT_EQ(rig.slave().velocity, 0);
  rig.cycles(3, 0.0, 0.25);
  EXPECT_EQ(rig.slave().velocity, 250);
  EXPECT_DOUBLE_EQ(rig.feedback().velocity, 0.25);
  rig.cycles(3, 0.0, 99.0);
  EXPECT_EQ(rig.slave().velocity, 2000) << "max_velocity";
  rig.slave().mute = true;
  rig.cycles(20, 0.0, 1.0);
  EXPECT_EQ(rig.feedback().state, DriveState::offline);
  rig.slave().mute = false;
  rig.slave().commands.clear();
  rig.cycles(20, 0.0, 1.0);
  for (const auto& command : rig.slave().commands) EXPECT_EQ(command.target, 0);
}

TEST(NetworkModes, ProfilePositionTakesEachSetPointOnce) {
  CanopenRig rig(1, OperationMode::profile_position);
  rig.configure();
  rig.enable();
  EXPECT_EQ(rig.slave().edges, 0) << "enabling is no movement";
  rig.cycles(12, 2.0);
  EXPECT_EQ(rig.slave().edges, 1);
  EXPECT_EQ(rig.slave().position, 1500);
  rig.cycles(12, 2.5);
  rig.cycles(12, 2.5);
  EXPECT_EQ(rig.slave().edges, 2);
  EXPECT_EQ(rig.slave().position, 2000);
}

}  // namespace
}  // namespace foresight::canopen::network_test
