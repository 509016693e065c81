// An operator of a served robot for scripts/test-line, which kills it, and the robot under it.
//
//   line_hand RIG move    takes control, has the robot enabled and homed, presses the switch until the robot follows,
//                         and swings the joint `elbow` until it is killed. Once the robot has followed and does no
//                         more, it holds the switch until SIGUSR1: then it lets go, and begins anew.
//                         Tells what becomes of it, a line each.
//   line_hand RIG watch   writes "unix time of the robot in ns, elbow in rad" of every joint state that comes
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <numbers>
#include <optional>
#include <utility>

#include "common/clock.hpp"
#include "common/error.hpp"
#include "common/suspension.hpp"
#include "link/control_wire/control_lines.hpp"
#include "link/messages/ros_messages.hpp"
#include "link/robot_side/rig_identity.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

constexpr const char* kJoint = "elbow";
constexpr Duration kCycle = 10ms;

volatile std::sig_atomic_t press_anew = 0;

/// Prints a line when it is another one than the last.
class Teller {
 public:
  void say(const std::string& line) {
    if (line == said_) return;
    said_ = line;
    std::cout << line << std::endl;
  }

 private:
  std::string said_;
};

class Hand {
 public:
  Hand(const Rig& rig, const std::string& file, Participant& program)
      : line_(program), seat_(options(rig, file)), elbow_(joint(rig)) {
    seat_.want_control(true);
  }

  void tick(const Clock& clock) {
    if (const auto asleep = suspension_.woke()) seat_.stood_still(*asleep);
    line_.receive(seat_, clock);
    const OperatorTime now{clock.now().ns};
    seat_.advance(now);
    const ControlSeatStatus status = seat_.status(now);
    for (; differences_ < status.differences.size(); ++differences_)
      std::cout << "differs: " << status.differences[differences_].words << std::endl;
    if (status.phase == ControlSeatStatus::Phase::holding)
      hold(now, status);
    else
      tell_.say("no control: " + status.words + "; " + status.cure);
    line_.send(seat_);
  }

 private:
  static ControlSeatOptions options(const Rig& rig, const std::string& file) {
    ControlSeatOptions out;
    out.identity = rig_identity(rig, file, FORESIGHT_VERSION);
    out.draw = machine_nonces();
    return out;
  }
  static std::size_t joint(const Rig& rig) {
    const std::vector<GateJoint> joints = rig.gate_options().joints;
    for (std::size_t j = 0; j < joints.size(); ++j)
      if (joints[j].name == kJoint) return j;
    throw InputError("the rig", std::string("has no joint '") + kJoint + "'", "take configs/minerva.yaml");
  }

  void hold(OperatorTime now, const ControlSeatStatus& status) {
    if (std::exchange(press_anew, 0) || (pressed_ && !followed_ && now - *ready_ > 2s)) let_go();
    if (status.follows) {
      followed_ = true;
      tell_.say("follows");
      swing_ += std::chrono::duration<double>(kCycle).count();
    } else {
      begin_ = seat_.begin();
      swing_ = 0;
      if (!pressed_)
        get_ready(now);
      else if (status.must_let_go)
        tell_.say("must let go");
    }
    LinePositions positions = begin_;
    // Towards zero: whoever begins anew again and again stays where the arm has room.
    positions[elbow_] += (begin_[elbow_] > 0 ? -0.15 : 0.15) * (1 - std::cos(std::numbers::pi * swing_));
    seat_.command(now, positions, pressed_);
  }

  /// For as long as a robot that is ready is looked at before a press, so that the open switch is seen.
  void let_go() {
    pressed_ = followed_ = false;
    ready_.reset();
  }

  /// Asks for all that may be missing; what is not is refused. Presses once the robot has been ready for a while.
  void get_ready(OperatorTime now) {
    if (seat_.state().ready) {
      if (!ready_) ready_ = now;
      pressed_ = now - *ready_ > 300ms;
      if (pressed_) ready_ = now;
      return;
    }
    ready_.reset();
    tell_.say("gets ready");
    if (now < ask_at_) return;
    constexpr std::array kAll{LineRequest::reset, LineRequest::enable, LineRequest::home};
    seat_.request(kAll[asked_++ % kAll.size()], now);
    ask_at_ = now + 500ms;
  }

  SeatLine line_;
  ControlSeat seat_;
  SuspensionWatch suspension_;
  std::size_t elbow_;
  Teller tell_;
  bool pressed_ = false;
  std::size_t differences_ = 0;  // that are told
  LinePositions begin_{};
  double swing_ = 0;                   // s that it has followed
  bool followed_ = false;              // since it began anew
  std::optional<OperatorTime> ready_;  // since when the robot is; once pressed, since the press
  OperatorTime ask_at_;
  std::size_t asked_ = 0;
};

[[noreturn]] void move(const Rig& rig, const std::string& file) {
  Participant program(rig.link, "hand", Role::operating);
  Hand hand(rig, file, program);
  MonotonicClock clock;
  for (RobotTime next = clock.now();; next = next + kCycle) {
    clock.sleep_until(next);
    hand.tick(clock);
  }
}

[[noreturn]] void watch(const Rig& rig) {
  Participant program(rig.link, "watcher");
  Reader joints(program, {"rt/joint_states", JointStateMessage::kType, Delivery::newest, 64});
  for (;;) {
    joints.wait(100ms);
    joints.take<JointStateMessage>({}, [](JointStateMessage&& state, const Sample&) {
      for (std::size_t j = 0; j < state.name.size(); ++j)
        if (state.name[j] == kJoint)
          std::printf("%d%09u,%.9f\n", state.header.stamp.sec, state.header.stamp.nanosec, state.position[j]);
    });
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace foresight::link

int main(int count, char** words) try {
  const std::string what = count == 3 ? words[2] : "";
  if (what != "move" && what != "watch") {
    std::cerr << "usage: line_hand RIG move|watch\n";
    return 2;
  }
  const foresight::Rig rig = foresight::read_rig(words[1]);
  std::signal(SIGUSR1, [](int) { foresight::link::press_anew = 1; });
  what == "move" ? foresight::link::move(rig, words[1]) : foresight::link::watch(rig);
} catch (const std::exception& error) {
  std::cerr << "line_hand: " << error.what() << '\n';
  return 1;
}
