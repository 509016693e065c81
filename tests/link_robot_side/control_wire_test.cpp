// Control's messages as bytes: what comes back, and what anybody may send instead.
#include "link/control_wire/control_wire.hpp"

#include "tests/control/any_messages.hpp"
#include "tests/support/mutated_bytes.hpp"

namespace foresight::link::control_wire_test {
namespace {

FromOperator set_point() {
  SetPoint out;
  out.deadman = true;
  out.joints = 2;
  out.position = {0.1, -0.2};
  return {4, 5, out};
}

std::string refusal(const FromOperator& message) {
  std::string why;
  EXPECT_FALSE(from_operator(to_bytes(message), &why));
  return why;
}

TEST(ControlWire, WhatCannotBeMeantIsRefusedInWords) {
  EXPECT_TRUE(from_operator(to_bytes(set_point())));
  FromOperator wrong = set_point();
  std::get<SetPoint>(wrong.body).position[1] = NAN;
  EXPECT_EQ(refusal(wrong), "position[1] is nan");
  wrong = set_point();
  std::get<SetPoint>(wrong.body).joints = 17;
  EXPECT_EQ(refusal(wrong), "17 joints");
  wrong.body = Request{1, static_cast<LineRequest>(200), 0, 0, {}, {}};
  EXPECT_EQ(refusal(wrong), "there is no request 200");
  wrong.body = Hello{sample_identity(std::string(1001, 'a'))};
  EXPECT_EQ(refusal(wrong), "name has 1001 characters");
  wrong.body = Hello{sample_identity("a\x1b[2J")};
  EXPECT_EQ(refusal(wrong), "name has control characters: 'a?[2J'");
  std::string why;
  EXPECT_FALSE(from_robot(std::vector<std::uint8_t>{0, 1, 0, 0, 9}, &why));
  EXPECT_EQ(why, "bytes are no such message");
}

/// How every version's Hello and Welcome begin, and then what this one knows nothing of.
template <typename... Fields>
Bytes of_another_version(const Fields&... fields) {
  Bytes out;
  CdrWriter writer(out);
  (writer("", fields), ...);
  writer("", std::vector<std::string>{"what", "is", "this"})("", 7.5);
  return out;
}

TEST(ControlWire, AnotherVersionSaysWhoItIs) {
  const std::uint32_t newer = kLineProtocol + 1;
  const Bytes hello =
      of_another_version(Nonce{4}, Nonce{0}, std::int32_t{0}, newer, std::string("9.1"), std::string("anna"));
  const auto greeted = from_operator(hello);
  ASSERT_TRUE(greeted);
  EXPECT_EQ(greeted->from, 4u);
  const Identity& anna = std::get<Hello>(greeted->body).identity;
  EXPECT_EQ(anna.protocol, newer);
  EXPECT_EQ(anna.name, "anna");
  const auto differ = differences(sample_identity("the robot"), anna);
  ASSERT_EQ(differ.size(), 2u) << "protocol and program; nothing is known of the rest";
  EXPECT_TRUE(differ[0].refuses);

  const Bytes welcome =
      of_another_version(Nonce{5}, Nonce{4}, std::int32_t{0}, Nonce{6}, newer, std::string("9.1"), std::string("lab"));
  const auto welcomed = from_robot(welcome);
  ASSERT_TRUE(welcomed);
  EXPECT_EQ(std::get<Welcome>(welcomed->body).robot, 6u);
  EXPECT_EQ(std::get<Welcome>(welcomed->body).identity.program, "9.1");

  EXPECT_FALSE(from_operator(
      of_another_version(Nonce{4}, Nonce{0}, std::int32_t{0}, kLineProtocol, std::string("9.1"), std::string("anna"))))
      << "of this version, but not as this version says it";
  EXPECT_FALSE(from_operator(
      of_another_version(Nonce{4}, Nonce{0}, std::int32_t{0}, newer, std::string("9.1"), std::string("a\x1b[2J"))));
  EXPECT_FALSE(from_operator(
      of_another_version(Nonce{4}, Nonce{5}, std::int32_t{3}, newer, std::string("9.1"), std::string("anna"))))
      << "no Hello";
}

// Whatever comes: it is refused in words, or goes out again as the same bytes, and its numbers can be used.
// FORESIGHT_FUZZ_RUNS inputs of each direction.
TEST(ControlWireFuzz, NoBytesDoHarm) {
  AnyMessages any;
  std::mt19937 random(5);
  const auto try_all = [&](const char* direction, auto next, auto read) {
    SCOPED_TRACE(direction);
    int taken = 0;
    const int runs = fuzz_runs();
    for (int i = 0; i < runs; ++i) {
      std::vector<std::uint8_t> bytes = to_bytes(next());
      for (std::size_t n = random() % 4; n > 0; --n) mutate(bytes, random);
      std::string why;
      const auto message = read(bytes, &why);
      ASSERT_NE(message.has_value(), !why.empty()) << why;
      if (!message) continue;
      ++taken;
      const std::vector<std::uint8_t> again = to_bytes(*message);
      const auto same = read(again, nullptr);
      ASSERT_TRUE(same);
      ASSERT_EQ(to_bytes(*same), again);
      if constexpr (std::same_as<std::remove_cvref_t<decltype(*message)>, FromOperator>) {
        const auto* point = std::get_if<SetPoint>(&message->body);
        for (std::size_t j = 0; point && j < point->joints; ++j) ASSERT_TRUE(std::isfinite(point->position.at(j)));
      }
    }
    EXPECT_GT(taken, runs / 8);
    EXPECT_LT(taken, runs);
  };
  try_all(
      "to the robot", [&] { return any.from_operator(); }, from_operator);
  try_all(
      "to the operator", [&] { return any.from_robot(); }, from_robot);
}

}  // namespace
}  // namespace foresight::link::control_wire_test
