#include "drivers/canopen/pdo.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "drivers/canopen/nmt.hpp"
#include "frames.hpp"

namespace foresight::canopen::pdo_test {
namespace {

using namespace std::chrono_literals;

TEST(Pdo, PacksAndUnpacks) {
  const Pdo pdo(PdoDirection::to_node, 1, 2, 0x202, 1, {{0x6040, 0, 16, false}, {0x607A, 0, 32, true}});
  CanFrame f = pdo.empty_frame();
  pdo.put(f, 1, -2);
  pdo.put(f, 0, 0x1234f);  // cut to 16 bits, and nothing else touched
  EXPECT_EQ(to_text(f), "202#4F23FEFFFFFF");
  EXPECT_EQ(pdo.get(f, 0), 0x234f);
  EXPECT_EQ(pdo.get(f, 1), -2);
}

TEST(Pdo, EntriesNeedNoByteBounds) {
  const Pdo pdo(PdoDirection::from_node, 2, 2, 0x282, 1,
                {{0x2000, 0, 3, true}, {0x2001, 0, 7, false}, {0x2002, 0, 54, true}});
  CanFrame f = pdo.empty_frame();
  EXPECT_EQ(f.size, 8);
  pdo.put(f, 2, -1);
  pdo.put(f, 1, 5);
  pdo.put(f, 0, -4);
  EXPECT_EQ(pdo.get(f, 0), -4);
  EXPECT_EQ(pdo.get(f, 1), 5);
  EXPECT_EQ(pdo.get(f, 2), -1);
}

TEST(Pdo, RefusesTruncatedFramesAndTooManyBits) {
  const Pdo pdo(PdoDirection::from_node, 1, 2, 0x182, 1, {{0x6041, 0, 16, false}});
  EXPECT_TRUE(pdo.carried_by(frame("182#4007")));
  EXPECT_TRUE(pdo.carried_by(frame("182#400700")));
  EXPECT_FALSE(pdo.carried_by(frame("182#40")));
  EXPECT_FALSE(pdo.carried_by(frame("183#4007")));
  CanFrame remote = frame("182#4007");
  remote.remote = true;
  EXPECT_FALSE(pdo.carried_by(remote));
  EXPECT_THROW(Pdo(PdoDirection::from_node, 1, 2, 0x182, 1, {{1, 0, 64, false}, {2, 0, 1, false}}), InputError);
  EXPECT_THROW(Pdo(PdoDirection::from_node, 1, 2, 0x182, 1, {}), InputError);
}

TEST(Heartbeat, ProducerKeepsItsPeriodThroughLateCalls) {
  HeartbeatProducer producer(20ms);
  int sent = 0;
  for (int t = 0; t < 1000; t += 3) sent += producer.due(RobotTime{t * 1'000'000});
  EXPECT_EQ(sent, 50);
  EXPECT_TRUE(producer.due(RobotTime{5'000'000'000}));
  EXPECT_FALSE(producer.due(RobotTime{5'001'000'000})) << "missed ones are not made up for";
}

TEST(Heartbeat, ConsumerNoticesSilence) {
  HeartbeatConsumer consumer(50ms);
  EXPECT_FALSE(consumer.state({}));
  consumer.heard(NmtState::operational, RobotTime{0});
  EXPECT_EQ(consumer.state(RobotTime{50'000'000}), NmtState::operational);
  EXPECT_FALSE(consumer.state(RobotTime{50'000'001}));
}

TEST(Heartbeat, ConsumerForgetsAStateButNoSilence) {
  HeartbeatConsumer consumer(50ms);
  EXPECT_FALSE(consumer.overdue(RobotTime{1'000'000'000})) << "never heard";
  consumer.heard(NmtState::operational, RobotTime{0});
  consumer.forget_state();
  EXPECT_FALSE(consumer.state(RobotTime{1}));
  EXPECT_FALSE(consumer.overdue(RobotTime{50'000'000}));
  EXPECT_TRUE(consumer.overdue(RobotTime{50'000'001}));
  consumer.heard(NmtState::pre_operational, RobotTime{60'000'000});
  EXPECT_EQ(consumer.state(RobotTime{60'000'001}), NmtState::pre_operational);
}

TEST(Heartbeat, ParsesStatesOnly) {
  EXPECT_EQ(parse_heartbeat(frame("703#00"))->state, NmtState::boot_up);
  EXPECT_EQ(parse_heartbeat(frame("703#7F"))->node, 3);
  EXPECT_FALSE(parse_heartbeat(frame("703#85"))) << "node guarding toggles bit 7";
  EXPECT_FALSE(parse_heartbeat(frame("700#05")));
  EXPECT_FALSE(parse_heartbeat(frame("703#")));
  EXPECT_EQ(to_text(nmt_frame(NmtCommand::reset_communication, 3)), "000#8203");
}

}  // namespace
}  // namespace foresight::canopen::pdo_test
