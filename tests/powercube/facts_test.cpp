// Every row of the recorded protocol facts against our tables, and frames to the byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/powercube/protocol.hpp"
#include "protocol_data.hpp"

namespace foresight::powercube::facts_test {
namespace {

using testing::ElementsAre;
using Kind = Message::Kind;

std::vector<unsigned> bytes(const CanFrame& f) {
  return {f.data.begin(), f.data.begin() + f.size};
}

CanFrame raw(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame f;
  f.id = id;
  for (std::uint8_t b : data) f.data[f.size++] = b;
  return f;
}

std::string first_word(const std::string& text) {
  return text.substr(0, text.find_first_of(" :"));
}

std::string type_name(ValueType type) {
  constexpr const char* kNames[] = {"float", "int32", "uint32", "int16", "uint16", "uint8"};
  return kNames[static_cast<std::size_t>(type)];
}

std::uint32_t mask_of(std::span<const BitName> bits, const std::string& name) {
  for (const BitName& bit : bits)
    if (bit.name == name) return bit.mask;
  return 0;
}

/// False: a kind of row that this test does not know.
bool check(const std::string& kind, unsigned code, const std::string& meaning, const std::string& type) {
  const auto c = static_cast<std::uint8_t>(code);
  const std::string name = first_word(meaning);
  if (kind == "param") {
    const ParamInfo* by_code = find_param(c);
    if (by_code == nullptr) return ADD_FAILURE() << meaning, true;
    EXPECT_EQ(by_code->name, meaning);
    EXPECT_EQ(type_name(by_code->type), type) << meaning;
    EXPECT_EQ(find_param(meaning), by_code);
    for (double value : {0.0, 1.0, 100.0}) {
      const Message set = decode(set_param(31, by_code->code, value));
      EXPECT_TRUE(set.is(Kind::set, by_code->code) && set.value == value && set.module == 31) << meaning;
    }
    EXPECT_TRUE(decode(get_param(1, by_code->code)).is(Kind::get, by_code->code));
  } else if (kind.starts_with("motion_")) {
    const MotionInfo* info = find_motion(c);
    if (info == nullptr) return ADD_FAILURE() << meaning, true;
    EXPECT_EQ(info->name, meaning);
    EXPECT_EQ(type_name(info->type), first_word(type)) << meaning;
    EXPECT_EQ(info->timed, type.ends_with(" ms")) << meaning;
    EXPECT_EQ(info->extended, kind == "motion_extended_ack") << meaning;
    const Message m = decode(motion(7, info->code, -3, 10));
    EXPECT_EQ(m.kind, Kind::motion);
    EXPECT_EQ(m.value, -3);
    EXPECT_EQ(m.milliseconds, info->timed ? 10 : 0);
  } else if (kind == "state_bit") {
    EXPECT_EQ(mask_of(state_bits(), meaning), code) << meaning;
    EXPECT_EQ(words(code, state_bits()), meaning);
  } else if (kind == "short_state_bit") {
    EXPECT_EQ(mask_of(short_state_bits(), name), code) << meaning;
  } else if (kind == "dio_bit") {
    EXPECT_EQ(mask_of(digital_io_bits(), meaning), code) << meaning;
  } else if (kind == "broadcast_cmd") {
    EXPECT_EQ(describe(raw(0x100, {c})), "to all: " + name);
  } else if (kind == "can_id_base") {
    EXPECT_TRUE(code == kAnswerId || code == kGetId || code == kPutId || code == kBroadcastId) << code;
  } else if (kind == "baud_code") {
    const int kbit = meaning.starts_with("1 M") ? 1000 : std::stoi(meaning);
    EXPECT_EQ(baud_code(kbit), c);
    EXPECT_EQ(baud_rate(c), kbit);
  } else {
    return kind == "cmd" || kind == "ack_format";  // below, to the byte
  }
  return true;
}

TEST(Facts, EveryRowIsUsed) {
  const auto file = can_data("powercube_m5/protocol_facts.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no protocol facts at " << file << "; set FORESIGHT_DATA";
  const auto rows = read_rows(file);
  EXPECT_EQ(rows.size(), 149u);
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), 4u);
    const auto code = row[0] == "ack_format" ? 0 : std::stoul(row[1], nullptr, 0);
    EXPECT_TRUE(check(row[0], static_cast<unsigned>(code), row[2], row[3])) << row[0] << ' ' << row[2];
  }
}

TEST(Frames, AreRightToTheByte) {
  EXPECT_EQ(get_param(3, Param::act_pos).id, 0x0C3u);
  EXPECT_THAT(bytes(get_param(3, Param::act_pos)), ElementsAre(0x0A, 0x3C));
  EXPECT_EQ(set_param(3, Param::max_vel, 1.5).id, 0x0E3u);
  EXPECT_THAT(bytes(set_param(3, Param::max_vel, 1.5)), ElementsAre(0x08, 0x48, 0, 0, 0xC0, 0x3F));
  EXPECT_THAT(bytes(command(3, Command::home)), ElementsAre(0x01));
  EXPECT_THAT(bytes(motion(3, Motion::fstep_ack, -1, 300)), ElementsAre(0x0B, 0x10, 0, 0, 0x80, 0xBF, 0x2C, 0x01));
  EXPECT_THAT(bytes(motion(3, Motion::icur, -2)), ElementsAre(0x0B, 0x0D, 0xFE, 0xFF));
  EXPECT_THAT(bytes(set_istep(3, -2, 10)), ElementsAre(0x0D, 0xFE, 0xFF, 0xFF, 0xFF, 0x0A, 0));
  EXPECT_EQ(broadcast(Command::watchdog_refresh).id, 0x100u);
  EXPECT_THAT(bytes(broadcast(Command::watchdog_refresh)), ElementsAre(0x07));
}

TEST(Frames, AnswersAreRead) {
  const Message simple = decode(raw(0x0A5, {0x0B, 0x06, 0x64}));
  EXPECT_EQ(simple.kind, Kind::motion_answer);
  EXPECT_TRUE(simple.accepted);
  const Message position = decode(raw(0x0A5, {0x0B, 0x10, 0, 0, 0x80, 0xBF, 0x30, 0x11}));
  EXPECT_EQ(position.kind, Kind::position);
  EXPECT_EQ(position.value, -1);
  EXPECT_EQ(position.short_state, 0x30);
  EXPECT_EQ(position.digital_io, 0x11);
  EXPECT_EQ(decode(raw(0x0A5, {0x0A, 0x35, 0xFE, 0xFF})).value, -2) << "int16 keeps its sign";
  EXPECT_EQ(decode(raw(0x0A5, {0x0B, 0x06, 0, 0, 0x80, 0xBF, 0x30, 0x11})).kind, Kind::unknown)
      << "FSTEP has no extended answer";
}

TEST(Frames, WhatIsNoneIsUnknown) {
  CanFrame good = get_param(3, Param::act_pos);
  for (bool CanFrame::*flag : {&CanFrame::extended, &CanFrame::remote, &CanFrame::error, &CanFrame::fd}) {
    CanFrame bad = good;
    bad.*flag = true;
    EXPECT_EQ(describe(bad), "unknown");
  }
  good.size = 1;
  EXPECT_EQ(describe(good), "unknown");
  EXPECT_EQ(describe(raw(0x0C0, {0x0A, 0x3C})), "unknown") << "module 0 does not exist";
  EXPECT_EQ(describe(raw(0x181, {1, 2})), "unknown");
  EXPECT_EQ(describe(raw(0x0A3, {})), "unknown");
}

TEST(Frames, InWords) {
  EXPECT_EQ(describe(get_param(3, Param::act_pos)), "to module 3: Get ActPos");
  EXPECT_EQ(describe(motion(3, Motion::fstep_ack, 0.5, 10)), "to module 3: FSTEP_ACK 0.5 in 10 ms");
  EXPECT_EQ(describe(raw(0x0A3, {0x0A, 0x27, 0x06, 0, 0, 0})), "module 3: CubeState = HOME_OK HALTED");
  EXPECT_EQ(describe(raw(0x0A3, {0x0B, 0x10, 0, 0, 0, 0x3F, 0x11, 0})),
            "module 3: FSTEP_ACK: position 0.5, NOT_OK MOTION, io 0");
  EXPECT_STREQ(fault_of(0x00200001), "short circuit in the power stage");
  EXPECT_STREQ(fault_of(0x00000001), "error");
  EXPECT_STREQ(fault_of(0x00000806), "");
  EXPECT_EQ(nearest_param("ActPosition"), "ActPos");
  EXPECT_EQ(find_param("actpos"), nullptr);
}

}  // namespace
}  // namespace foresight::powercube::facts_test
