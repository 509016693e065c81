#include "drivers/canopen/cia402.hpp"

#include <gtest/gtest.h>

#include "drivers/canopen/cia402_machine.hpp"

namespace foresight::canopen::cia402_test {
namespace {

using S = Cia402State;

TEST(Cia402, StatusWords) {
  // CiA 402-2, table 30; x bits both ways.
  const std::pair<int, S> kWords[] = {{0x00, S::not_ready},
                                      {0x40, S::switch_on_disabled},
                                      {0x21, S::ready_to_switch_on},
                                      {0x23, S::switched_on},
                                      {0x27, S::operation_enabled},
                                      {0x07, S::quick_stop_active},
                                      {0x0f, S::fault_reaction_active},
                                      {0x08, S::fault}};
  for (const auto& [word, state] : kWords)
    for (const int others : {0x0000, 0xff10, 0x0080, 0x0710})
      EXPECT_EQ(state_of(static_cast<std::uint16_t>(word | others)), state);
  EXPECT_EQ(state_of(0x0218), S::fault);
  EXPECT_EQ(state_of(0x0737), S::operation_enabled);
  EXPECT_EQ(state_of(0x0060), S::switch_on_disabled) << "bit 5 does not count here";
  EXPECT_FALSE(state_of(0x0001));
  EXPECT_FALSE(state_of(0x0067));
}

TEST(Cia402, TransitionsByNumber) {
  const struct {
    S from, to;
    int number;
  } kAll[] = {{S::not_ready, S::switch_on_disabled, 1},
              {S::switch_on_disabled, S::ready_to_switch_on, 2},
              {S::ready_to_switch_on, S::switched_on, 3},
              {S::switched_on, S::operation_enabled, 4},
              {S::operation_enabled, S::switched_on, 5},
              {S::switched_on, S::ready_to_switch_on, 6},
              {S::ready_to_switch_on, S::switch_on_disabled, 7},
              {S::operation_enabled, S::ready_to_switch_on, 8},
              {S::operation_enabled, S::switch_on_disabled, 9},
              {S::switched_on, S::switch_on_disabled, 10},
              {S::operation_enabled, S::quick_stop_active, 11},
              {S::quick_stop_active, S::switch_on_disabled, 12},
              {S::operation_enabled, S::fault_reaction_active, 13},
              {S::switch_on_disabled, S::fault_reaction_active, 13},
              {S::fault_reaction_active, S::fault, 14},
              {S::fault, S::switch_on_disabled, 15},
              {S::quick_stop_active, S::operation_enabled, 16}};
  for (const auto& t : kAll)
    EXPECT_EQ(transition_between(t.from, t.to), t.number) << to_string(t.from) << " to " << to_string(t.to);
  EXPECT_FALSE(transition_between(S::fault, S::operation_enabled));
  EXPECT_FALSE(transition_between(S::switch_on_disabled, S::operation_enabled));
}

TEST(Cia402, CommandOfEachTransition) {
  const struct {
    S from, to;
    int word;
  } kCommanded[] = {
      {S::switch_on_disabled, S::ready_to_switch_on, 0x06}, {S::ready_to_switch_on, S::switched_on, 0x07},
      {S::switched_on, S::operation_enabled, 0x0f},         {S::operation_enabled, S::switched_on, 0x07},
      {S::switched_on, S::ready_to_switch_on, 0x06},        {S::ready_to_switch_on, S::switch_on_disabled, 0x00},
      {S::operation_enabled, S::ready_to_switch_on, 0x06},  {S::operation_enabled, S::switch_on_disabled, 0x00},
      {S::switched_on, S::switch_on_disabled, 0x00},        {S::operation_enabled, S::quick_stop_active, 0x02},
      {S::quick_stop_active, S::switch_on_disabled, 0x00},  {S::fault, S::switch_on_disabled, 0x80},
      {S::quick_stop_active, S::operation_enabled, 0x0f}};
  for (const auto& c : kCommanded) {
    const auto command = next_command(c.from, c.to);
    ASSERT_TRUE(command) << to_string(c.from);
    EXPECT_EQ(control_word(*command), c.word) << to_string(c.from) << " to " << to_string(c.to);
  }
  EXPECT_FALSE(next_command(S::not_ready, S::operation_enabled)) << "1 comes by itself";
  EXPECT_FALSE(next_command(S::fault_reaction_active, S::operation_enabled)) << "14 comes by itself";
}

// Any state leads to any goal, in the smallest number of steps that the table allows.
TEST(Cia402, EveryGoalIsReached) {
  for (const S goal :
       {S::switch_on_disabled, S::ready_to_switch_on, S::switched_on, S::operation_enabled, S::quick_stop_active})
    for (const S start : {S::switch_on_disabled, S::ready_to_switch_on, S::switched_on, S::operation_enabled,
                          S::quick_stop_active, S::fault}) {
      S state = start;
      int steps = 0;
      for (; state != goal && steps < 8; ++steps) {
        const auto command = next_command(state, goal);
        ASSERT_TRUE(command) << to_string(state) << " to " << to_string(goal);
        for (const Transition& t : transitions())
          if (t.from == state && t.command == command) {
            state = t.to;
            break;
          }
      }
      EXPECT_EQ(state, goal) << "from " << to_string(start);
    }
}

TEST(Cia402, CommandsByTheirBits) {
  using C = Cia402Command;
  for (const C c : {C::shutdown, C::switch_on, C::enable_operation, C::disable_voltage, C::quick_stop, C::fault_reset})
    EXPECT_EQ(command_of(control_word(c)), c);
  EXPECT_EQ(command_of(0x1f), C::enable_operation);
  EXPECT_EQ(command_of(0x0d), C::disable_voltage) << "bit 1 low takes the voltage away, whatever the others say";
}

struct Machine : testing::Test {
  Cia402Machine machine{OperationMode::cyclic_position, true};
  Cia402Machine::Input in{0x0240, 8, true, false};
  RobotTime now;
  int step(int status) {
    in.status = static_cast<std::uint16_t>(status);
    now = now + std::chrono::milliseconds(10);
    return machine.step(in, now);
  }
  void enable() {
    machine.request(DriveRequest::enable);
    for (const int status : {0x240, 0x221, 0x223, 0x1227}) step(status);
  }
};

TEST_F(Machine, EnablesStepByStep) {
  EXPECT_EQ(step(0x240), 0x00);
  machine.request(DriveRequest::enable);
  EXPECT_EQ(step(0x240), 0x06);
  EXPECT_EQ(machine.state(), DriveState::enabling);
  EXPECT_EQ(step(0x221), 0x07);
  EXPECT_EQ(step(0x223), 0x0f);
  EXPECT_FALSE(machine.follows());
  EXPECT_EQ(step(0x1227), 0x0f);
  EXPECT_TRUE(machine.follows());
  EXPECT_EQ(machine.last_transition(), 4);
}

TEST_F(Machine, FaultEndsItAndResetIsAnEdge) {
  enable();
  EXPECT_EQ(step(0x22f), 0x00);
  EXPECT_EQ(machine.last_transition(), 13);
  EXPECT_EQ(machine.state(), DriveState::fault);
  EXPECT_EQ(step(0x228), 0x00);
  EXPECT_EQ(machine.last_transition(), 14);
  machine.request(DriveRequest::enable);
  EXPECT_EQ(step(0x228), 0x00) << "a fault has to be reset first";
  machine.request(DriveRequest::reset_fault);
  EXPECT_EQ(step(0x228), 0x00);
  EXPECT_EQ(step(0x228), 0x00);
  EXPECT_EQ(step(0x228), 0x80);
  EXPECT_EQ(step(0x240), 0x00);
  EXPECT_EQ(machine.last_transition(), 15);
  EXPECT_EQ(machine.state(), DriveState::disabled);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(step(0x240), 0x00) << "it does not come back by itself";
}

TEST_F(Machine, AFaultThatRemainsIsGivenUp) {
  step(0x228);
  machine.request(DriveRequest::reset_fault);
  for (int i = 0; i < 40; ++i) step(0x228);
  EXPECT_EQ(step(0x228), 0x00);
  EXPECT_STRNE(machine.trouble(), "");
}

TEST_F(Machine, QuickStopOverridesAndHolds) {
  enable();
  machine.request(DriveRequest::quick_stop);
  machine.request(DriveRequest::enable);
  EXPECT_EQ(step(0x1227), 0x02);
  EXPECT_FALSE(machine.follows());
  EXPECT_EQ(step(0x207), 0x02);
  EXPECT_EQ(machine.last_transition(), 11);
  EXPECT_EQ(machine.state(), DriveState::stopping);
  machine.request(DriveRequest::enable);
  EXPECT_EQ(step(0x207), 0x0f);
  EXPECT_EQ(step(0x1227), 0x0f);
  EXPECT_EQ(machine.last_transition(), 16);
  EXPECT_TRUE(machine.follows());
  machine.request(DriveRequest::quick_stop);
  step(0x1227);
  step(0x207);
  machine.request(DriveRequest::disable);
  EXPECT_EQ(step(0x207), 0x00);
  step(0x240);
  EXPECT_EQ(machine.last_transition(), 12);
}

TEST_F(Machine, DisablesOverSwitchedOn) {
  enable();
  machine.request(DriveRequest::disable);
  EXPECT_EQ(step(0x1227), 0x07);
  EXPECT_EQ(machine.state(), DriveState::stopping);
  EXPECT_EQ(step(0x223), 0x00);
  EXPECT_EQ(machine.last_transition(), 5);
  step(0x240);
  EXPECT_EQ(machine.last_transition(), 10);
  EXPECT_EQ(machine.state(), DriveState::disabled);
}

TEST_F(Machine, ADriveThatLeavesOperationIsNotPulledBack) {
  for (const auto& [status, transition] : {std::pair{0x223, 5}, {0x221, 8}, {0x240, 9}, {0x207, 11}}) {
    machine.restart();
    step(0x240);
    enable();
    ASSERT_TRUE(machine.follows());
    for (int i = 0; i < 5; ++i) EXPECT_NE(step(status), 0x0f) << status;
    EXPECT_EQ(machine.last_transition(), transition);
    for (int i = 0; i < 3; ++i) EXPECT_NE(step(0x1227), 0x0f) << "nor when its word says otherwise again";
  }
}

TEST_F(Machine, LosingThePermissionOrTheModeStops) {
  enable();
  in.may_enable = false;
  EXPECT_EQ(step(0x1227), 0x02);
  in.may_enable = true;
  EXPECT_EQ(step(0x1227), 0x02);
  machine.restart();
  step(0x240);
  enable();
  in.mode_shown = 1;
  EXPECT_EQ(step(0x1227), 0x02);
  in.mode_shown = 8;
  machine.restart();
  step(0x240);
  enable();
  in.error_told = true;
  EXPECT_EQ(step(0x1227), 0x02);
}

TEST_F(Machine, EnablingHasAnEnd) {
  machine.request(DriveRequest::enable);
  for (int i = 0; i < 310; ++i) step(0x240);
  EXPECT_EQ(step(0x240), 0x00);
  EXPECT_STREQ(machine.trouble(), "the drive did not enable in time");
}

TEST_F(Machine, HomingOnlyFromEnabled) {
  machine.request(DriveRequest::home);
  step(0x240);
  EXPECT_EQ(machine.wanted_mode(), OperationMode::cyclic_position);
  enable();
  machine.request(DriveRequest::home);
  EXPECT_EQ(step(0x1627), 0x0f) << "bits 10 and 12 of another mode are no homing attained";
  EXPECT_EQ(machine.wanted_mode(), OperationMode::homing);
  in.mode_shown = 6;
  EXPECT_EQ(step(0x1627), 0x0f);
  EXPECT_EQ(step(0x1627), 0x1f);
  EXPECT_EQ(step(0x1627), 0x1f) << "may be the last homing's";
  EXPECT_EQ(step(0x227), 0x1f);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(step(0x227), 0x1f);
  EXPECT_FALSE(machine.homed());
  EXPECT_EQ(step(0x1627), 0x0f);
  EXPECT_TRUE(machine.homed());
  EXPECT_FALSE(machine.follows()) << "still the other mode";
  in.mode_shown = 8;
  step(0x1227);
  EXPECT_TRUE(machine.follows());
}

}  // namespace
}  // namespace foresight::canopen::cia402_test
