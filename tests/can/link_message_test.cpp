// The kernel's messages on links, made up here: what is read of them, and that nothing beyond them is.
#include "drivers/can/link_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/rtnetlink.h>
#include <netlink/attr.h>
#include <netlink/msg.h>

#include <cerrno>
#include <cstring>
#include <random>

#include "tests/support/allocations.hpp"

namespace foresight::link_message_test {
namespace {

/// Writes attributes one after the other, as RFC 3549 has them.
class Message {
 public:
  Message(int type, unsigned flags, unsigned short device = ARPHRD_CAN) : bytes_(NLMSG_LENGTH(sizeof(ifinfomsg))) {
    ifinfomsg link{};
    link.ifi_type = device;
    link.ifi_index = 7;
    link.ifi_flags = flags;
    std::memcpy(bytes_.data() + NLMSG_HDRLEN, &link, sizeof link);
    type_ = static_cast<std::uint16_t>(type);
  }
  template <typename Value>
  Message& put(unsigned short type, const Value& value) {
    return put(type, &value, sizeof value);
  }
  Message& put(unsigned short type, const std::string& text) { return put(type, text.c_str(), text.size() + 1); }
  Message& put(unsigned short type, const void* data, std::size_t size) {
    const rtattr head{static_cast<unsigned short>(RTA_LENGTH(size)), type};
    append(&head, sizeof head);
    append(data, size);
    bytes_.resize(NLMSG_ALIGN(bytes_.size()));
    return *this;
  }
  std::size_t open(unsigned short type) {
    put(type, nullptr, 0);
    return bytes_.size() - RTA_LENGTH(0);
  }
  void close(std::size_t at) {
    const auto size = static_cast<unsigned short>(bytes_.size() - at);
    std::memcpy(bytes_.data() + at, &size, sizeof size);
  }
  std::vector<char>& bytes() {
    nlmsghdr header{};
    header.nlmsg_len = static_cast<std::uint32_t>(bytes_.size());
    header.nlmsg_type = type_;
    std::memcpy(bytes_.data(), &header, sizeof header);
    return bytes_;
  }
  const nlmsghdr& header() { return *reinterpret_cast<const nlmsghdr*>(bytes().data()); }

 private:
  void append(const void* data, std::size_t size) {
    const auto* from = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
  }
  std::vector<char> bytes_;
  std::uint16_t type_ = 0;
};

Message controller(std::uint32_t state, unsigned flags = IFF_UP) {
  Message out(RTM_NEWLINK, flags);
  out.put(IFLA_IFNAME, std::string("can3")).put(IFLA_MTU, std::uint32_t{CANFD_MTU}).put(IFLA_TXQLEN, 10u);
  rtnl_link_stats64 stats{};
  stats.rx_packets = 11, stats.tx_packets = 12, stats.rx_dropped = 3, stats.rx_over_errors = 1, stats.tx_dropped = 5;
  out.put(IFLA_STATS64, stats);
  const std::size_t info = out.open(IFLA_LINKINFO);
  out.put(IFLA_INFO_KIND, std::string("can"));
  const std::size_t data = out.open(IFLA_INFO_DATA);
  can_bittiming timing{}, fast{};
  timing.bitrate = 500'000, timing.sample_point = 875, fast.bitrate = 2'000'000;
  out.put(IFLA_CAN_BITTIMING, timing).put(IFLA_CAN_DATA_BITTIMING, fast).put(IFLA_CAN_STATE, state);
  out.put(IFLA_CAN_RESTART_MS, 100u).put(IFLA_CAN_BERR_COUNTER, can_berr_counter{96, 128});
  out.close(data);
  can_device_stats counters{};
  counters.bus_off = 2, counters.restarts = 1;
  out.put(IFLA_INFO_XSTATS, counters);
  out.close(info);
  return out;
}

TEST(LinkMessage, AllOfAControllerIsRead) {
  Message message = controller(CAN_STATE_ERROR_PASSIVE);
  const auto link = read_can_interface(message.header());
  ASSERT_TRUE(link);
  EXPECT_EQ(link->name, "can3");
  EXPECT_EQ(link->index, 7);
  EXPECT_EQ(link->kind, "can");
  EXPECT_TRUE(link->up);
  EXPECT_TRUE(link->fd);
  EXPECT_EQ(link->state, CanBusState::passive);
  EXPECT_EQ(link->bit_rate, 500'000);
  EXPECT_EQ(link->data_bit_rate, 2'000'000);
  EXPECT_DOUBLE_EQ(link->sample_point.value_or(0), 0.875);
  EXPECT_EQ(link->restart_ms, 100);
  EXPECT_EQ(link->transmit_errors, 96);
  EXPECT_EQ(link->receive_errors, 128);
  EXPECT_EQ(link->bus_offs, 2u);
  EXPECT_EQ(link->received, 11u);
  EXPECT_EQ(link->sent, 12u);
  EXPECT_EQ(link->receive_dropped, 4u);
  EXPECT_EQ(link->send_dropped, 5u);
  EXPECT_EQ(link->transmit_queue, 10);
}

TEST(LinkMessage, AVirtualBusHasNoController) {
  Message message(RTM_NEWLINK, IFF_UP);
  message.put(IFLA_IFNAME, std::string("vcan0")).put(IFLA_MTU, std::uint32_t{CAN_MTU});
  const std::size_t info = message.open(IFLA_LINKINFO);
  message.put(IFLA_INFO_KIND, std::string("vcan"));
  message.close(info);
  const auto link = read_can_interface(message.header());
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "vcan");
  EXPECT_FALSE(link->fd);
  EXPECT_EQ(link->state, CanBusState::active);
  EXPECT_FALSE(link->bit_rate || link->restart_ms || link->transmit_errors || link->bus_offs);
}

TEST(LinkMessage, WhatIsDownIsDown) {
  EXPECT_EQ(read_can_interface(controller(CAN_STATE_ERROR_ACTIVE, 0).header())->state, CanBusState::down);
  EXPECT_EQ(read_can_interface(controller(CAN_STATE_STOPPED).header())->state, CanBusState::down);
}

TEST(LinkMessage, OthersAreNone) {
  EXPECT_FALSE(read_can_interface(Message(RTM_NEWLINK, IFF_UP, ARPHRD_ETHER).header()));
  EXPECT_FALSE(read_link_state(Message(RTM_NEWLINK, IFF_UP, ARPHRD_ETHER).header()));
  EXPECT_FALSE(read_link_state(Message(RTM_NEWADDR, IFF_UP).header()));
  EXPECT_FALSE(read_can_interface(Message(RTM_DELLINK, IFF_UP).header()));
}

TEST(LinkMessage, StateIsReadWithoutAllocation) {
  Message off = controller(CAN_STATE_BUS_OFF), gone(RTM_DELLINK, 0);
  const nlmsghdr &of_off = off.header(), &of_gone = gone.header();
  std::optional<LinkState> a, b;
  const auto before = allocations();
  for (int i = 0; i < 1000; ++i) {
    a = read_link_state(of_off);
    b = read_link_state(of_gone);
  }
  EXPECT_EQ(allocations() - before, 0u);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->index, 7);
  EXPECT_TRUE(a->up && !a->gone);
  EXPECT_EQ(a->state, CanBusState::bus_off);
  EXPECT_TRUE(b->gone && !b->up && !b->state);
}

// Any bytes behind a header whose length is right; run with a sanitizer to see reads beyond them.
TEST(LinkMessage, DamagedBytesStayWithinTheMessage) {
  std::mt19937 random(5);
  const std::vector<char> whole = controller(CAN_STATE_ERROR_WARNING).bytes();
  int read = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<char> bytes(whole.begin(),
                            whole.begin() + static_cast<std::ptrdiff_t>(16 + random() % (whole.size() - 15)));
    for (int k = 0; k < 3; ++k)
      if (bytes.size() > 32) bytes[32 + random() % (bytes.size() - 32)] = static_cast<char>(random());
    const auto size = static_cast<std::uint32_t>(bytes.size());
    std::memcpy(bytes.data(), &size, sizeof size);
    const auto& header = *reinterpret_cast<const nlmsghdr*>(bytes.data());
    read_link_state(header);
    if (const auto link = read_can_interface(header)) read += link->name.size() <= bytes.size();
  }
  EXPECT_GT(read, 1000);
}

// A request without the attribute is answered as if it had been followed.
TEST(CanRestart, NamesWhatTheDriverShallDo) {
  const NetlinkMessage message = restart_message(7);
  nlmsghdr* const header = nlmsg_hdr(message.get());
  EXPECT_EQ(header->nlmsg_type, RTM_NEWLINK);
  EXPECT_EQ(static_cast<const ifinfomsg*>(nlmsg_data(header))->ifi_index, 7);
  nlattr* const info = nlmsg_find_attr(header, sizeof(ifinfomsg), IFLA_LINKINFO);
  ASSERT_NE(info, nullptr);
  const auto inside = [](nlattr* outer, int type) {
    return nla_find(static_cast<nlattr*>(nla_data(outer)), nla_len(outer), type);
  };
  ASSERT_NE(inside(info, IFLA_INFO_KIND), nullptr);
  EXPECT_STREQ(nla_get_string(inside(info, IFLA_INFO_KIND)), "can");
  nlattr* const data = inside(info, IFLA_INFO_DATA);
  ASSERT_NE(data, nullptr);
  ASSERT_NE(inside(data, IFLA_CAN_RESTART), nullptr);
  EXPECT_EQ(nla_get_u32(inside(data, IFLA_CAN_RESTART)), 1u);
}

// No such interface, or no right: either way the kernel answers, and nothing is allocated while it does.
TEST(CanRestart, AsksTheKernelWithoutAllocation) {
  CanRestart restart(0x7ffffff0);
  const auto before = allocations();
  const int first = restart(), second = restart();
  EXPECT_EQ(allocations() - before, 0u);
  EXPECT_THAT(first, testing::AnyOf(EPERM, ENODEV)) << std::strerror(first);
  EXPECT_EQ(second, first);
}

}  // namespace
}  // namespace foresight::link_message_test
