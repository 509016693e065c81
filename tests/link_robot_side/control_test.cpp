// An operator over the line and an emulated robot, in stepped time: only the bytes between them are DDS'.
#include "link/control_wire/control_wire.hpp"

#include <set>

#include "link/robot_side/rig_identity.hpp"
#include "link/robot_side/robot_messages.hpp"
#include "link/robot_side/served_operator.hpp"
#include "tests/control/small_line.hpp"
#include "tests/link/child.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::control_test {
namespace {

using namespace std::chrono_literals;

class ServedControl : public PrivateNetworkTest {
 protected:
  void SetUp() override {
    PrivateNetworkTest::SetUp();
    if (IsSkipped()) return;
    robot_.get_moving();
    robot_.robot().submit(robot_.command(false));  // whoever moved it lets go
    robot_.run(2s);
    seat_.want_control(true);
  }
  ControlDeskOptions desk_options() {
    ControlDeskOptions out;
    out.identity = identity_;
    out.draw = counting(1001);
    return out;
  }
  ControlSeatOptions seat_options() {
    ControlSeatOptions out;
    out.identity = identity_;
    out.draw = counting(1'000'001);
    return out;
  }
  /// 10 ms of both sides; the operator's says `positions` where it holds the lease.
  void tick(const LinePositions& positions, bool deadman, bool operator_lives = true) {
    robot_.run(10ms);
    const RobotTime now = robot_.clock().now();
    if (operator_lives) {
      const OperatorTime here{now.ns};
      operator_line_.receive(seat_, robot_.clock());
      seat_.advance(here);
      if (seat_.status(here).phase == ControlSeatStatus::Phase::holding) seat_.command(here, positions, deadman);
      operator_line_.send(seat_);
    }
    Commander* const commander = &served_;
    serve(std::span(&commander, 1), robot_.robot(), now);
  }
  /// The lease is there, and the switch was seen open.
  LinePositions take_control() {
    for (int i = 0; i < 300 && !seat_.state().ready; ++i) tick(seat_.begin(), false);
    EXPECT_TRUE(seat_.state().ready) << seat_.status(OperatorTime{robot_.clock().now().ns}).words;
    for (int i = 0; i < 5; ++i) tick(seat_.begin(), false);
    return seat_.begin();
  }

  Duration asleep_{0};
  LiveRobot robot_{"minerva.yaml"};
  Identity identity_ = rig_identity(robot_.rig(), source_folder() / "configs" / "minerva.yaml", "test");
  Participant program_{LinkConfig{}, "test"};
  ServedOperator served_{program_,       robot_.rig().gate_options(),
                         desk_options(), robot_.clock(),
                         nullptr,        SuspensionWatch([this] { return asleep_; })};
  SeatLine operator_line_{program_};
  ControlSeat seat_{seat_options()};
};

TEST_F(ServedControl, AnOperatorOverTheLineMovesTheRobotAndItRestsWhenTheLineIsGone) {
  LinePositions positions = take_control();
  const std::size_t elbow = robot_.joint("elbow");
  const double begin = positions[elbow];
  for (int i = 0; i < 300; ++i) {
    tick(positions, true);
    positions[elbow] = begin + 0.2 * std::min(1.0, i / 200.0);
  }
  EXPECT_EQ(robot_.robot().status().gate.state, GateState::following);
  EXPECT_EQ(robot_.robot().status().gate.operator_id, LineOperator::kId);
  EXPECT_NEAR(robot_.shaft(elbow).position, begin + 0.2, 0.02);
  for (int i = 0; i < 100; ++i) tick({}, true, /*operator_lives=*/false);
  EXPECT_EQ(robot_.robot().status().gate.state, GateState::idle);
  robot_.expect_at_rest("a second after the operator's last word");
  robot_.expect_limits_kept("all the while");
}

TEST_F(ServedControl, AfterASuspensionOfTheRobotsHostNothingMovesWithoutAnotherPress) {
  const LinePositions positions = take_control();
  for (int i = 0; i < 50; ++i) tick(positions, true);
  ASSERT_EQ(robot_.robot().status().gate.state, GateState::following);
  asleep_ += 5s;
  for (int i = 0; i < 200; ++i) tick(positions, true);
  EXPECT_EQ(robot_.robot().status().gate.state, GateState::idle);
  EXPECT_TRUE(seat_.status(OperatorTime{robot_.clock().now().ns}).must_let_go);
}

/// A thread that is put aside at each look at it.
class SlowClock final : public Clock {
 public:
  RobotTime now() const noexcept override { return now_ = now_ + 1ms; }
  void sleep_until(RobotTime) noexcept override {}

 private:
  mutable RobotTime now_{1'000'000'000};
};

TEST_F(ServedControl, EachMessageIsTakenInAtAnInstantOfItsOwn) {
  ControlDesk desk(desk_options());
  DeskLine line(program_);
  Writer writer(program_, {"rt/foresight/control/operator/messages", kFromOperatorType, Delivery::newest, 64});
  const SlowClock clock;
  const auto answers = [&](std::size_t count) {
    std::vector<FromRobot> out;
    comes_true([&] {
      line.receive(desk, clock);
      std::ranges::move(desk.take_outgoing(), std::back_inserter(out));
      return out.size() >= count;
    });
    return out;
  };
  writer.write(to_bytes(FromOperator{7, 0, Hello{identity_}}));
  const std::vector<FromRobot> welcome = answers(1);
  ASSERT_EQ(welcome.size(), 1u);
  for (const std::uint64_t number : {1, 2, 3})
    writer.write(to_bytes(FromOperator{7, welcome[0].from, ClockPing{number}}));
  std::set<std::int64_t> instants;
  for (const FromRobot& pong : answers(3)) instants.insert(std::get<ClockPong>(pong.body).received_ns);
  EXPECT_EQ(instants.size(), 3u);
}

TEST_F(ServedControl, TheRobotsStateNamesWhoStoppedIt) {
  const LinePositions positions = take_control();
  for (int i = 0; i < 50; ++i) tick(positions, true);
  ASSERT_EQ(robot_.robot().status().gate.state, GateState::following);
  seat_.request(LineRequest::emergency_stop, OperatorTime{robot_.clock().now().ns});
  for (int i = 0; i < 100; ++i) tick(positions, true);
  const RobotState state = robot_state(robot_.robot().status(), robot_.rig(), served_.taken().stopper());
  EXPECT_THAT(state.doing.name, testing::EndsWith("(asked for over the line by '" + identity_.name + "')"));
}

// What somebody else writes on the same topics, and on those that look like it, moves nothing.
TEST_F(ServedControl, StrangersMoveNothing) {
  const LinePositions positions = take_control();
  Writer stranger(program_, {"rt/foresight/control/operator/messages", kFromOperatorType, Delivery::newest, 64});
  Writer trajectory(program_, {"rt/foresight/set_points", JointTrajectory::kType, Delivery::newest, 8});
  const std::size_t elbow = robot_.joint("elbow");
  const double before = robot_.shaft(elbow).position;
  const std::uint64_t accepted = robot_.robot().status().gate.accepted;
  for (std::uint64_t i = 0; i < 200; ++i) {
    SetPoint far;
    far.lease = far.consent = far.sequence = i;
    far.given = OperatorTime{robot_.clock().now().ns};
    far.lasts = 1s;
    far.deadman = true;
    far.joints = 10;
    far.position = positions;
    far.position[elbow] += 0.5;
    stranger.write(to_bytes(FromOperator{i, 1001, far}));
    stranger.write(Bytes{0, 1, 0, 0, 1, 2, 3});
    JointTrajectory path;
    path.joint_names = {"elbow"};
    path.points.resize(1);
    path.points[0].positions = {before + 0.5};
    trajectory.write(path);
    tick({}, false, /*operator_lives=*/false);
  }
  EXPECT_NEAR(robot_.shaft(elbow).position, before, 1e-3);
  EXPECT_LE(robot_.robot().status().gate.accepted, accepted + 30) << "but what the operator had sent before";
  EXPECT_EQ(program_.refused(), 200u);
  EXPECT_EQ(program_.refusal(), "rt/foresight/control/operator/messages: bytes are no such message");
  robot_.expect_at_rest("whatever strangers write");
}

}  // namespace
}  // namespace foresight::link::control_test
