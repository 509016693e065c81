#include "tests/drives/wire.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <bit>

#include "sim/drives/object_dictionary.hpp"

namespace foresight::sim {

CanFrame frame(std::uint32_t id, std::initializer_list<int> bytes) {
  CanFrame out;
  out.id = id;
  for (int b : bytes) out.data[out.size++] = static_cast<std::uint8_t>(b);
  return out;
}

std::vector<std::uint8_t> bytes_of(const CanFrame& frame) {
  return {frame.payload().begin(), frame.payload().end()};
}

std::string text_of(const CanFrame& frame) {
  std::string out = fmt::format("{:03X}#", frame.id);
  for (std::uint8_t b : frame.payload()) out += fmt::format("{:02X}", b);
  return out;
}

CanFrame frame_of(const std::string& text) {
  CanFrame out;
  out.id = static_cast<std::uint32_t>(std::stoul(text.substr(0, 3), nullptr, 16));
  for (std::size_t i = 4; i + 1 < text.size(); i += 2)
    out.data[out.size++] = static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16));
  return out;
}

Wire::Wire(const std::vector<NodeConfig>& nodes) : rack(clock, bus.attach(), nodes) {}

std::optional<CanFrame> Wire::wait(std::uint32_t id, Duration patience) {
  const RobotTime until = clock.now() + patience;
  while (const auto got = end->receive(until - clock.now()))
    if (got->id == id) return got;
  return std::nullopt;
}

std::vector<CanFrame> Wire::pass(Duration time) {
  const RobotTime until = clock.now() + time;
  std::vector<CanFrame> out;
  while (const auto got = end->receive(until - clock.now())) out.push_back(*got);
  return out;
}

std::uint32_t Wire::download(int node, unsigned index, unsigned sub, std::int64_t value, int size) {
  CanFrame out =
      frame(0x600u + static_cast<unsigned>(node), {0x23 | (4 - size) << 2, static_cast<int>(index & 0xff),
                                                   static_cast<int>(index >> 8), static_cast<int>(sub), 0, 0, 0, 0});
  encode_integer(value, std::span(out.data).subspan(4, static_cast<std::size_t>(size)));
  send(out);
  const auto answer = wait(0x580u + static_cast<unsigned>(node));
  if (!answer) return 1;
  return answer->data[0] == 0x80 ? static_cast<std::uint32_t>(decode_integer(answer->payload().subspan(4, 4), false))
                                 : 0;
}

std::optional<std::int64_t> Wire::upload(int node, unsigned index, unsigned sub) {
  send(0x600u + static_cast<unsigned>(node),
       {0x40, static_cast<int>(index & 0xff), static_cast<int>(index >> 8), static_cast<int>(sub), 0, 0, 0, 0});
  const auto answer = wait(0x580u + static_cast<unsigned>(node));
  aborted = answer ? 0 : 1;
  if (!answer) return std::nullopt;
  if (answer->data[0] == 0x80) {
    aborted = static_cast<std::uint32_t>(decode_integer(answer->payload().subspan(4, 4), false));
    return std::nullopt;
  }
  const std::size_t size = 4u - (answer->data[0] >> 2 & 3u);
  return decode_integer(answer->payload().subspan(4, size), true);
}

std::uint16_t Wire::control(int node, int controlword) {
  EXPECT_EQ(download(node, 0x6040, 0, controlword, 2), 0u);
  pass(2ms);
  return status(node);
}

void Wire::enable(int node) {
  pass(5ms);
  send(0, {1, node});
  for (int word : {6, 7, 15}) control(node, word);
  ASSERT_EQ(status(node) & 0x6F, 0x27);
}

std::optional<float> Wire::real(int module, int parameter) {
  send(0x0C0u + static_cast<unsigned>(module), {0x0A, parameter});
  const auto answer = wait(0x0A0u + static_cast<unsigned>(module));
  if (!answer || answer->size != 6 || answer->data[1] != parameter) return std::nullopt;
  return std::bit_cast<float>(static_cast<std::uint32_t>(decode_integer(answer->payload().subspan(2, 4), false)));
}

std::uint32_t Wire::state(int module) {
  return std::bit_cast<std::uint32_t>(real(module, 0x27).value_or(0));
}

std::optional<CanFrame> Wire::motion(int module, int motion, float value, int time_ms) {
  CanFrame out = frame(0x0E0u + static_cast<unsigned>(module), {0x0B, motion, 0, 0, 0, 0});
  encode_integer(std::bit_cast<std::uint32_t>(value), std::span(out.data).subspan(2, 4));
  if (time_ms >= 0) {
    encode_integer(time_ms, std::span(out.data).subspan(6, 2));
    out.size = 8;
  }
  send(out);
  return wait(0x0A0u + static_cast<unsigned>(module), 5ms);
}

void Wire::home(int module) {
  send(0x0E0u + static_cast<unsigned>(module), {0x01});
  ASSERT_TRUE(wait(0x0A0u + static_cast<unsigned>(module)));
  for (int i = 0; i < 2000 && (state(module) & 2) == 0; ++i) pass(10ms);
  ASSERT_TRUE(state(module) & 2) << "HOME_OK";
}

NodeConfig cia402_drive(int node) {
  NodeConfig out;
  out.kind = NodeConfig::Kind::cia402;
  out.node = node;
  out.name = "drive_" + std::to_string(node);
  out.counts_per_unit = 1000;
  out.serial = 4711;
  return out;
}

NodeConfig powercube_module(int module) {
  NodeConfig out = cia402_drive(module);
  out.kind = NodeConfig::Kind::powercube;
  out.min_position = -1.5;
  out.max_position = 1.5;
  return out;
}

}  // namespace foresight::sim
