// Needs an interface that loops back what is sent, vcan0 unless FORESIGHT_CAN names another: scripts/test-devices.
#include "drivers/can/socket_can_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <sys/socket.h>

#include <cstring>

#include "common/clock.hpp"
#include "common/error.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/can/kernel_frame.hpp"
#include "tests/can/frames.hpp"

namespace foresight::socket_can_bus_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(KernelFrame, RoundTrips) {
  std::mt19937 random(7);
  for (int i = 0; i < 10000; ++i) {
    const CanFrame f = random_frame(random);
    ASSERT_TRUE(is_sendable(f));
    canfd_frame raw;
    const std::size_t size = to_kernel(f, raw);
    ASSERT_EQ(size, f.fd ? CANFD_MTU : CAN_MTU);
    const auto back = from_kernel(raw, size);
    ASSERT_TRUE(back && same(*back, f)) << to_text(f);
  }
}

TEST(KernelFrame, AnyBytesGiveAFrameWithinItsBounds) {
  std::mt19937 random(8);
  for (int i = 0; i < 10000; ++i) {
    canfd_frame raw;
    auto* bytes = reinterpret_cast<unsigned char*>(&raw);
    for (std::size_t k = 0; k < sizeof raw; ++k) bytes[k] = static_cast<unsigned char>(random());
    const auto f = from_kernel(raw, i % 2 ? CAN_MTU : CANFD_MTU);
    ASSERT_TRUE(f);
    ASSERT_LE(f->size, f->fd ? 64 : 8);
    ASSERT_LE(f->id, 0x1fffffffu);
  }
  EXPECT_FALSE(from_kernel({}, 17));
}

TEST(SocketCanOptions, ValidateNamesTheValue) {
  SocketCanOptions options;
  options.receive_buffer = 1;
  EXPECT_THROW(options.validate(), InputError);
  options = {};
  options.filters = {{0x800, 0x7ff, false}};
  EXPECT_THROW(options.validate(), InputError);
}

TEST(SocketCanBus, WithoutCanInTheKernelSaysWhatToDo) {
  if (has_can_sockets()) GTEST_SKIP() << "this kernel has CAN";
  try {
    SocketCanBus bus("can0");
    FAIL() << "no error";
  } catch (const RuntimeFailure& error) {
    EXPECT_THAT(error.what(), HasSubstr("'can0': open a socket: this kernel has no CAN"));
    EXPECT_THAT(error.what(), HasSubstr("modprobe can-raw"));
    EXPECT_THAT(error.what(), HasSubstr("in-process bus"));
  }
  EXPECT_NO_THROW(can_interfaces());
}

class SocketCan : public testing::Test {
 protected:
  void SetUp() override {
    const char* chosen = std::getenv("FORESIGHT_CAN");
    name_ = chosen ? chosen : "vcan0";
    if (!has_can_sockets()) GTEST_SKIP() << "this kernel has no CAN (AF_CAN); scripts/test-devices brings one";
    const auto interface = find_can_interface(name_);
    if (!interface || !interface->up)
      GTEST_SKIP() << "no interface " << name_ << " that is up; see scripts/test-devices";
  }
  std::string name_;
};

/// What no CanBus sends: error frames.
void send_error(const std::string& interface, std::uint32_t error_class, std::uint8_t controller = 0) {
  const auto found = find_can_interface(interface);
  const UniqueFd socket(::socket(AF_CAN, SOCK_RAW, CAN_RAW));
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = found->index;
  ASSERT_EQ(bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  can_frame frame{};
  frame.can_id = error_class | CAN_ERR_FLAG;
  frame.len = 8;
  frame.data[1] = controller;
  ASSERT_EQ(write(socket.get(), &frame, sizeof frame), static_cast<ssize_t>(sizeof frame));
}

TEST_F(SocketCan, CarriesEveryKindOfFrameBothWays) {
  SocketCanOptions options;
  options.fd = true;
  SocketCanBus a(name_, options), b(name_, options);
  std::mt19937 random(9);
  for (int i = 0; i < 1000; ++i) {
    const CanFrame f = random_frame(random);
    SocketCanBus &from = i % 2 ? a : b, &to = i % 2 ? b : a;
    const RobotTime before = MonotonicClock().now();
    ASSERT_EQ(from.send(f), CanSend::sent) << to_text(f);
    const auto got = to.receive(1s);
    ASSERT_TRUE(got && same(*got, f)) << i << " " << to_text(f);
    // The kernel's stamp, moved by an offset that was measured later: it may miss by the clock's steering.
    EXPECT_GT(got->time, before - 1ms);
    EXPECT_LE(got->time, MonotonicClock().now());
    ASSERT_FALSE(from.receive(0ms)) << "its own";
  }
  EXPECT_EQ(a.counters().sent, 500u);
  EXPECT_EQ(a.counters().received, 500u);
}

TEST_F(SocketCan, ReceiveWaitsAsLongAsAsked) {
  SocketCanBus bus(name_);
  const MonotonicClock clock;
  const RobotTime start = clock.now();
  EXPECT_FALSE(bus.receive(50ms));
  EXPECT_GE(clock.now() - start, 50ms);
}

TEST_F(SocketCan, ClassicBusRefusesFd) {
  SocketCanBus bus(name_);
  CanFrame f = frame(1);
  f.fd = true;
  EXPECT_EQ(bus.send(f), CanSend::invalid);
  EXPECT_EQ(bus.send(frame(0x800)), CanSend::invalid);
  EXPECT_EQ(bus.counters().send_failures, 0u);
}

TEST_F(SocketCan, FiltersInTheKernelButNotErrorFrames) {
  SocketCanOptions options;
  options.filters = {{0x180, 0x780, false}, {0x1abcdef0, 0x1ffffff0, true}};
  SocketCanBus filtered(name_, options), sender(name_);
  CanFrame extended = frame(0x1abcdef5), look_alike = frame(0x181);
  extended.extended = look_alike.extended = true;
  for (const CanFrame& f : {frame(0x181), frame(0x201), extended, look_alike}) sender.send(f);
  send_error(name_, CAN_ERR_BUSERROR);
  EXPECT_EQ(filtered.receive(1s).value_or(CanFrame{}).id, 0x181u);
  EXPECT_EQ(filtered.receive(1s).value_or(CanFrame{}).id, 0x1abcdef5u);
  const auto error = filtered.receive(1s);
  ASSERT_TRUE(error && error->error);
  EXPECT_FALSE(filtered.receive(20ms));
}

TEST_F(SocketCan, ErrorFramesMoveTheState) {
  SocketCanBus bus(name_);
  const auto after = [&](std::uint32_t error_class, std::uint8_t controller = 0) {
    send_error(name_, error_class, controller);
    const auto f = bus.receive(1s);
    EXPECT_TRUE(f && f->error && f->id == error_class);
    return bus.state();
  };
  EXPECT_EQ(bus.state(), CanBusState::active);
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING), CanBusState::warning);
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE | CAN_ERR_CRTL_TX_WARNING), CanBusState::passive);
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE), CanBusState::active);
  EXPECT_EQ(after(CAN_ERR_BUSOFF), CanBusState::bus_off);
  EXPECT_EQ(bus.send(frame(1)), CanSend::bus_down);
  EXPECT_EQ(after(CAN_ERR_RESTARTED), CanBusState::active);
  EXPECT_EQ(bus.send(frame(1)), CanSend::sent);
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW), CanBusState::active);
  EXPECT_EQ(bus.counters().restarts, 1u);
  EXPECT_EQ(bus.counters().error_frames, 6u);
  EXPECT_EQ(bus.counters().lost, 1u);
}

TEST_F(SocketCan, CountsWhatTheSocketHadNoRoomFor) {
  SocketCanOptions small;
  small.receive_buffer = 4096;
  SocketCanBus reader(name_, small), writer(name_);
  constexpr int kFrames = 2000;
  for (int i = 0; i < kFrames; ++i) ASSERT_EQ(writer.send(frame(1)), CanSend::sent);
  int read = 0;
  while (reader.receive(0ms)) ++read;
  EXPECT_LT(read, kFrames);
  // The count travels with the next frame that does get room.
  writer.send(frame(2));
  ASSERT_TRUE(reader.receive(1s));
  EXPECT_EQ(read + static_cast<int>(reader.counters().lost), kFrames);
}

TEST_F(SocketCan, FollowsTheLinkDownAndUp) {
  if (name_.substr(0, 4) != "vcan") GTEST_SKIP() << "only done to vcan";
  SocketCanBus bus(name_), other(name_);
  const std::string link = "ip link set " + name_;
  if (std::system((link + " down").c_str()) != 0) GTEST_SKIP() << "may not set " << name_ << " down";
  EXPECT_FALSE(bus.receive(20ms));
  EXPECT_EQ(bus.state(), CanBusState::down);
  EXPECT_EQ(bus.send(frame(1)), CanSend::bus_down);
  EXPECT_EQ(other.send(frame(1)), CanSend::bus_down) << "it has not read of it yet";
  try {
    SocketCanBus third(name_);
    ADD_FAILURE() << "opened";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run `" + link + " up`"));
  }
  ASSERT_EQ(std::system((link + " up").c_str()), 0);
  EXPECT_FALSE(bus.receive(20ms));
  EXPECT_FALSE(other.receive(20ms));
  EXPECT_EQ(bus.state(), CanBusState::active);
  EXPECT_EQ(bus.send(frame(2)), CanSend::sent);
  EXPECT_EQ(other.receive(1s).value_or(CanFrame{}).id, 2u);
}

TEST_F(SocketCan, NamesTheInterfacesThatThereAre) {
  try {
    SocketCanBus bus("can99");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'can99': find: no such CAN interface"));
    EXPECT_THAT(error.what(), HasSubstr(name_));
  }
}

// tests/devices/can_slcan.sh takes an interface to bus-off first.
TEST(SocketCanRestart, BringsABusBackFromBusOff) {
  const char* interface = std::getenv("FORESIGHT_CAN_BUS_OFF");
  if (interface == nullptr) GTEST_SKIP() << "FORESIGHT_CAN_BUS_OFF names no interface in bus-off";
  SocketCanOptions options;
  options.restart_after_bus_off = true;
  SocketCanBus bus(interface, options);
  ASSERT_EQ(bus.state(), CanBusState::bus_off);
  EXPECT_EQ(bus.send(frame(1)), CanSend::bus_down);
  const RobotTime give_up = MonotonicClock().now() + 5s;
  while (bus.state() != CanBusState::active && MonotonicClock().now() < give_up) bus.receive(10ms);
  EXPECT_EQ(bus.state(), CanBusState::active) << std::strerror(bus.restart_error());
  EXPECT_EQ(bus.counters().restarts, 1u);
  EXPECT_EQ(bus.send(frame(1)), CanSend::sent);
}

}  // namespace
}  // namespace foresight::socket_can_bus_test
