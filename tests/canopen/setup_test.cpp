#include <gmock/gmock.h>

#include "common/error.hpp"
#include "scripted_slave.hpp"

namespace foresight::canopen::setup_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

template <typename Error, typename F>
std::string thrown(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(Setup, WritesAndProvesEverything) {
  CanopenRig rig;
  rig.configure();
  ScriptedSlave& s = rig.slave();
  EXPECT_STREQ(rig.drive().refusal(), "");
  EXPECT_EQ(s.object(0x1016, 1).value, 0x7f0064u);
  EXPECT_EQ(s.object(0x1017).value, 50u);
  EXPECT_EQ(s.object(0x1029, 1).value, 0u);
  EXPECT_EQ(s.object(0x6007).value, 3u);
  EXPECT_EQ(s.object(0x605A).value, 6u);
  EXPECT_EQ(static_cast<std::int32_t>(s.object(0x607D, 1).value), -10500);
  EXPECT_EQ(static_cast<std::int32_t>(s.object(0x607D, 2).value), 9500);
  EXPECT_EQ(s.object(0x607F).value, 2000u);
  for (const std::uint16_t index : {0x6083, 0x6084, 0x6085}) EXPECT_EQ(s.object(index).value, 5000u);
  EXPECT_EQ(s.object(0x60C2, 1).value, 10u);
  EXPECT_EQ(s.object(0x60C2, 2).value, 0xfdu);
  EXPECT_EQ(s.object(0x6060).value, 8u);
  EXPECT_EQ(s.object(0x6099, 1).value, 50u);
  EXPECT_EQ(s.object(0x1400, 1).value, 0x201u);
  EXPECT_EQ(s.object(0x1400, 2).value, 1u);
  EXPECT_EQ(s.object(0x1600, 0).value, 2u);
  EXPECT_EQ(s.object(0x1600, 1).value, 0x60400010u);
  EXPECT_EQ(s.object(0x1600, 2).value, 0x607A0020u);
  EXPECT_EQ(s.object(0x1800, 1).value, 0x40000181u) << "the bit against remote requests stays";
  EXPECT_EQ(s.object(0x1A00, 2).value, 0x60640020u);
  EXPECT_EQ(s.object(0x1A01, 1).value, 0x606C0020u);
  EXPECT_EQ(s.object(0x1A01, 2).value, 0x60610008u);
  EXPECT_TRUE(s.object(0x1401, 1).value & 0x80000000) << "no PDO that nobody asked for";
  EXPECT_TRUE(s.object(0x1803, 1).value & 0x80000000);
  EXPECT_EQ(s.nmt, 5);
  EXPECT_GT(s.heartbeats_heard, 0) << "a consumer starts with the first heartbeat";
  EXPECT_EQ(rig.feedback().state, DriveState::disabled);
  EXPECT_DOUBLE_EQ(rig.feedback().position, 1.5);
}

TEST(Setup, PdosOfAnotherMasterAreTakenOver) {
  CanopenRig rig;
  ScriptedSlave& s = rig.slave();
  s.object(0x1400, 1).value = 0x333;  // the slave lets its other bits change only while bit 31 is set
  s.object(0x1600, 0).value = 3;
  s.object(0x1600, 3).value = 0x60FF0020;
  rig.configure();
  EXPECT_EQ(s.object(0x1400, 1).value, 0x201u);
  EXPECT_EQ(s.object(0x1600, 0).value, 2u);
}

TEST(Setup, LimitsOfATurnedMotorAreTurnedToo) {
  CanopenRig rig(2);
  rig.configure();
  EXPECT_EQ(static_cast<std::int32_t>(rig.slave(1).object(0x607D, 1).value), -9500);
  EXPECT_EQ(static_cast<std::int32_t>(rig.slave(1).object(0x607D, 2).value), 10500);
}

TEST(Setup, AnotherDeviceIsRefusedByName) {
  CanopenRig rig;
  rig.slave().object(0x1000).value = 0x00030191;
  EXPECT_THAT(thrown<InputError>([&] { rig.drive().identify(); }),
              HasSubstr("joint_1 (node 1 on can0): device type (1000h) is 0x30191, profile 401"));
  rig.slave().object(0x1000).value = 0x00020192;
  Cia402Config config = rig.drive_config(1);
  config.drive.serial = 77;
  CanopenNetwork network(*rig.master, rig.clock, {}, {config});
  EXPECT_THAT(thrown<InputError>([&] { network.drive(0).identify(); }),
              HasSubstr("serial number (1018:04) is 0x400 but the rig expects 0x4D"));
}

TEST(Setup, SilenceIsAFailureNotAHang) {
  CanopenRig rig;
  rig.slave().mute = true;
  EXPECT_THAT(thrown<RuntimeFailure>([&] { rig.drive().identify(); }),
              HasSubstr("reading object 1000:00 got no answer"));
  EXPECT_LE(rig.clock.now().ns, 1'000'000'000);
  EXPECT_EQ(rig.feedback().state, DriveState::offline);
}

void expect_never_enabled(CanopenRig& rig, const char* reason) {
  rig.configure();
  EXPECT_THAT(rig.drive().refusal(), HasSubstr(reason));
  rig.enable();
  EXPECT_EQ(rig.feedback().state, DriveState::disabled);
  EXPECT_THAT(rig.feedback().fault, HasSubstr(reason));
  for (const auto& command : rig.slave().commands) EXPECT_EQ(command.word, 0);
}

TEST(Setup, NoConsumerHeartbeatNoEnabling) {
  CanopenRig rig;
  rig.slave().remove(0x1016);
  expect_never_enabled(rig, "no consumer heartbeat (1016h)");
}

TEST(Setup, UnprovenConsumerHeartbeatNoEnabling) {
  CanopenRig rig;
  rig.slave().object(0x1016, 1).keeps = false;
  expect_never_enabled(rig, "did not keep the consumer heartbeat (1016h)");
}

TEST(Setup, UnprovenAbortOptionNoEnabling) {
  CanopenRig rig;
  rig.slave().object(0x6007).keeps = false;
  expect_never_enabled(rig, "did not keep the abort connection option (6007h)");
  CanopenRig without;
  without.slave().remove(0x6007);
  expect_never_enabled(without, "6007h");
}

TEST(Setup, TellsOfADriveThatStaysOperationalWhenWeFallSilent) {
  CanopenRig rig;
  rig.slave().object(0x1029, 1).keeps = false;
  rig.configure();
  EXPECT_STREQ(rig.drive().refusal(), "");
  EXPECT_THAT(rig.drive().remarks(), testing::Contains(HasSubstr("1029h:01")));
  CanopenRig stops;
  stops.slave().object(0x1029, 1) = {.value = 2, .bytes = 1, .keeps = false};
  stops.configure();
  EXPECT_THAT(stops.drive().remarks(), testing::Not(testing::Contains(HasSubstr("1029h"))));
  CanopenRig without;
  without.slave().remove(0x1029);
  without.configure();
  EXPECT_THAT(without.drive().remarks(), testing::Not(testing::Contains(HasSubstr("1029h"))));
}

TEST(Setup, NoHeartbeatOfTheDriveNoEnabling) {
  CanopenRig rig;
  rig.slave().remove(0x1017);
  rig.configure();
  EXPECT_THAT(rig.drive().refusal(), HasSubstr("1017h"));
  rig.enable();
  EXPECT_NE(rig.feedback().state, DriveState::enabled);
}

TEST(Setup, OurConsumerEntryIsUsedAgain) {
  CanopenRig rig;
  rig.slave().object(0x1016, 1).value = 0x050064;
  rig.slave().object(0x1016, 2).value = 0x7f0010;
  rig.configure();
  EXPECT_EQ(rig.slave().object(0x1016, 1).value, 0x050064u) << "somebody else's";
  EXPECT_EQ(rig.slave().object(0x1016, 2).value, 0x7f0064u);
}

TEST(Setup, LimitsThatTheDriveChangesAreErrorsMissingOnesAreNotes) {
  CanopenRig rig;
  rig.slave().object(0x607F).keeps = false;
  EXPECT_THAT(thrown<InputError>([&] { rig.configure(); }), HasSubstr("2000 as largest profile velocity (607F:00)"));
  rig.enable();
  EXPECT_NE(rig.feedback().state, DriveState::enabled) << "set-up was not finished";
  CanopenRig without;
  without.slave().remove(0x607F);
  without.configure();
  EXPECT_THAT(without.drive().remarks(), testing::Contains(HasSubstr("607F:00")));
  without.enable();
  EXPECT_EQ(without.feedback().state, DriveState::enabled);
}

TEST(Setup, UnsupportedModeAndUnkeptMappingAreErrors) {
  CanopenRig rig;
  rig.slave().object(0x6502).value = 0x21;
  EXPECT_THAT(thrown<InputError>([&] { rig.configure(); }), HasSubstr("cyclic synchronous position"));
  CanopenRig mapping;
  mapping.slave().object(0x1600, 2).keeps = false;
  EXPECT_THAT(thrown<InputError>([&] { mapping.configure(); }), HasSubstr("1600:02"));
}

TEST(Setup, AHomingMethodThatTheDriveLacksIsSaidAtOnce) {
  CanopenRig rig;
  rig.slave().object(0x60E3, 0) = {2, 1};
  rig.slave().object(0x60E3, 1) = {17, 2};    // INTEGER16
  rig.slave().object(0x60E3, 2) = {0xfe, 1};  // INTEGER8: -2
  EXPECT_THAT(thrown<InputError>([&] { rig.configure(); }), HasSubstr("it has 17, -2 (60E3h)"));
  rig.slave().object(0x60E3, 2) = {static_cast<std::uint32_t>(rig.drive_config(1).homing_method), 2};
  rig.configure();
  rig.slave().remove(0x60E3);
  rig.slave().object(0x6098) = {0, 1, false};
  EXPECT_THAT(thrown<InputError>([&] { rig.configure(); }), HasSubstr("does not take homing method"));
}

TEST(Setup, ADriveFoundEnabledIsSwitchedOff) {
  CanopenRig rig;
  rig.slave().state = 0x27;
  rig.configure();
  EXPECT_EQ(rig.slave().state, 0x40);
  EXPECT_EQ(rig.feedback().state, DriveState::disabled);
}

TEST(Setup, ConfigsAreChecked) {
  CanopenRig rig;
  const auto error = [&](auto change) {
    Cia402Config config = rig.drive_config(1);
    NetworkConfig network;
    change(config, network);
    return thrown<InputError>([&] { CanopenNetwork(*rig.master, rig.clock, network, {config}); });
  };
  EXPECT_THAT(error([](auto& c, auto&) { c.drive.node = 128; }), HasSubstr("node is 128"));
  EXPECT_THAT(error([](auto& c, auto&) { c.drive.node = 127; }), HasSubstr("127 is taken already"));
  EXPECT_THAT(error([](auto& c, auto&) { c.drive.counts_per_unit = 0; }), HasSubstr("counts_per_unit is 0"));
  EXPECT_THAT(error([](auto& c, auto&) { c.quick_stop_option = 2; }), HasSubstr("quick_stop_option is 2"));
  EXPECT_THAT(error([](auto& c, auto&) { c.drive.max_position = 1e9; }), HasSubstr("max_position"));
  EXPECT_THAT(error([](auto&, auto& n) { n.heartbeat = 50ms; }), HasSubstr("heartbeat is 50"));
  EXPECT_THAT(thrown<InputError>([&] {
                CanopenNetwork(*rig.master, rig.clock, {}, {rig.drive_config(1), rig.drive_config(1)});
              }),
              HasSubstr("taken already"));
}

}  // namespace
}  // namespace foresight::canopen::setup_test
