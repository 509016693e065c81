#include "link/config/link_config.hpp"
#include "common/error.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight::link_config_test {
namespace {

using testing::HasSubstr;

LinkConfig read(const std::string& text) {
  return read_link_config(YamlMap::parse("rig.yaml", text));
}

auto refused_as(const char* text) {
  return testing::ThrowsMessage<InputError>(HasSubstr(text));
}

TEST(LinkConfig, EveryKeyIsRead) {
  const LinkConfig config = read(
      "domain: 7\ninterface: wg0\npeers: [10.8.0.2, operator.lab]\njoint_rate_hz: 100\nstate_rate_hz: 5\n"
      "image_rate_hz: 15\ncoding: h264\njpeg_quality: 70\nround_trip_s: 0.6\nsecurity: keys\n");
  EXPECT_EQ(config.domain, 7);
  EXPECT_EQ(config.interface, "wg0");
  EXPECT_EQ(config.peers, (std::vector<std::string>{"10.8.0.2", "operator.lab"}));
  EXPECT_EQ(config.joint_rate_hz, 100);
  EXPECT_EQ(config.state_rate_hz, 5);
  EXPECT_EQ(config.image_rate_hz, 15);
  EXPECT_EQ(config.coding, LinkCoding::h264);
  EXPECT_EQ(config.jpeg_quality, 70);
  EXPECT_EQ(config.round_trip, std::chrono::milliseconds(600));
  EXPECT_EQ(config.security, "keys") << "whether it is there matters where the link is opened";
  EXPECT_FALSE(config.loopback());
}

TEST(LinkConfig, WhatCannotBeIsRefusedWithItsLine) {
  EXPECT_THAT([] { read("domain: 0\ninterfaces: lo\n"); }, refused_as("rig.yaml:2: interfaces: unknown key"));
  EXPECT_THAT([] { read("domain: 231\n"); }, refused_as("rig.yaml:1: domain: is 231"));
  EXPECT_THAT([] { read("interface: 'a\"/><x'\n"); }, refused_as("cannot be the name of a network interface"));
  EXPECT_THAT([] { read("peers: 10.0.0.1\n"); }, refused_as("peers: is not a list"));
  EXPECT_THAT([] { read("peers: ['10.0.0.1\"/>']\n"); }, refused_as("neither an address nor the name of a host"));
  EXPECT_THAT([] { read("coding: h265\n"); }, refused_as("h264"));
  EXPECT_THAT([] { read("jpeg_quality: 0\n"); }, refused_as("jpeg_quality: is 0"));
  EXPECT_THAT([] { read("round_trip_s: 2.5\n"); }, refused_as("round_trip_s: is 2.5; give the line's round trip"));
  EXPECT_THAT([] { read("joint_rate_hz: 0\n"); }, refused_as("give a number above 0"));
  EXPECT_THAT([] { read("image_rate_hz: 1e6\n"); }, refused_as("give at most 1000"));
  EXPECT_THAT([] { read("state_rate_hz: 0.5\n"); }, refused_as("give at least 1"));
}

}  // namespace
}  // namespace foresight::link_config_test
