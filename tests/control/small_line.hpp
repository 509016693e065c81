// A desk and seats that talk over lines that a test can cut, in stepped time.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <memory>

#include "link/control/control_desk.hpp"
#include "link/control/control_seat.hpp"

namespace foresight {

/// Draws 1, 2, 3, ...: all of one program that counts from `first`.
inline DrawNonce counting(Nonce first) {
  return [next = std::make_shared<Nonce>(first)] { return (*next)++; };
}

inline Identity sample_identity(const std::string& name) {
  return {kLineProtocol, "1.0", name, 11, 22, 33, {"arm", "wrist"}};
}

inline ControlDeskOptions desk_options() {
  ControlDeskOptions out;
  out.identity = sample_identity("the robot");
  out.draw = counting(1'000'000);
  return out;
}

/// The operator's end of a line of constant delay, its clock 1,000 s ahead.
struct SmallSeat {
  explicit SmallSeat(const std::string& name, Nonce first) : SmallSeat(sample_identity(name), first) {}
  SmallSeat(const Identity& identity, Nonce first) : seat({identity, counting(first)}) {}
  ControlSeat seat;
  std::deque<std::pair<RobotTime, FromOperator>> up;
  std::deque<std::pair<RobotTime, FromRobot>> down;
  bool up_cut = false, down_cut = false;  ///< what is sent meanwhile is lost
  bool held = false;                      ///< the switch
  LinePositions position{};
  bool commands = true;
  Duration ahead = std::chrono::seconds(1000);
};

class SmallLineTest : public testing::Test {
 protected:
  explicit SmallLineTest(Duration delay = std::chrono::milliseconds(20)) : delay_(delay) {
    robot_.joints = 2;
    robot_.ready = true;
    robot_.reach = {0.1, 0.1};
  }
  /// Ten milliseconds: seats, line, desk, a robot that follows at once.
  void step() {
    now_ = now_ + std::chrono::milliseconds(10);
    for (SmallSeat* seat : seats_) step_seat(*seat);
    desk_.advance(now_, robot_);
    for (auto request = desk_.take_request(); request != LineRequest::none; request = desk_.take_request())
      executed_.push_back(request);
    const LineMotion motion = desk_.motion(now_);
    robot_.follows = motion.what == LineMotion::What::follow;
    robot_.ready = robot_ready_ && !robot_.follows;
    if (robot_.follows) robot_.measured = robot_.set_point = robot_.begin = motion.position;
    followed_ += robot_.follows;
    for (const FromRobot& message : desk_.take_outgoing())
      for (SmallSeat* seat : seats_)
        if (!seat->down_cut) seat->down.push_back({now_ + delay_, message});
  }
  void step_seat(SmallSeat& it) {
    const OperatorTime here{(now_ + it.ahead).ns};
    while (!it.down.empty() && it.down.front().first <= now_) {
      it.seat.receive(it.down.front().second, here);
      it.down.pop_front();
    }
    it.seat.advance(here);
    if (it.commands) it.seat.command(here, it.position, it.held);
    for (FromOperator& message : it.seat.take_outgoing()) {
      sent_.push_back(message);
      if (!it.up_cut) it.up.push_back({now_ + delay_, std::move(message)});
    }
    while (!it.up.empty() && it.up.front().first <= now_) {
      desk_.receive(it.up.front().second, now_);
      it.up.pop_front();
    }
  }
  void run(Duration time) {
    for (const RobotTime end = now_ + time; now_ < end;) step();
  }
  /// What has moved since, where the switch is held all the time.
  int moves_in(Duration time) {
    followed_ = 0;
    run(time);
    return followed_;
  }
  std::uint64_t dropped(SetPointFault fault) const { return desk_.counts().faults[static_cast<std::size_t>(fault)]; }
  /// Until the seat drives, its switch held.
  void engage(SmallSeat& it) {
    it.seat.want_control(true);
    it.held = false;
    run(std::chrono::seconds(1));
    ASSERT_EQ(status(it).phase, ControlSeatStatus::Phase::holding) << status(it).words;
    it.held = true;
    run(std::chrono::milliseconds(200));
    ASSERT_TRUE(robot_.follows) << status(it).words;
  }
  ControlSeatStatus status(const SmallSeat& it) const { return it.seat.status({(now_ + it.ahead).ns}); }
  OperatorTime time_of(const SmallSeat& it) const { return {(now_ + it.ahead).ns}; }

  RobotTime now_{5'000'000'000};
  Duration delay_;
  RobotView robot_;
  bool robot_ready_ = true;
  ControlDesk desk_{desk_options()};
  SmallSeat anna_{"anna", 1}, ben_{"ben", 100'000};
  std::vector<SmallSeat*> seats_{&anna_};
  std::vector<FromOperator> sent_;
  std::vector<LineRequest> executed_;
  int followed_ = 0;
};

}  // namespace foresight
