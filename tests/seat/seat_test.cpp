// A seat at a served mock rig, over DDS and a line that takes 60 ms each way, in stepped time.
#include "seat/seat.hpp"
#include "link/control/motion_permit.hpp"
#include "link/dds/pretended_line.hpp"
#include "link/line/line_spec.hpp"
#include "link/robot_side/rig_identity.hpp"
#include "link/robot_side/robot_server.hpp"
#include "seat/tour.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::seat_test {
namespace {

using namespace std::chrono_literals;

LineSpec slow_line() {
  LineSpec out;
  out.up.delay = out.down.delay = 60ms;
  return out;
}

/// Does what a test says, and remembers what it was told.
class ToldDriver final : public SeatDriver {
 public:
  explicit ToldDriver(SeatDriver& script) : script_(script) {}
  SeatWish tick(const SeatView& view) override {
    seen = view;
    SeatWish out = scripted ? script_.tick(view) : wish;
    if (scripted) wish = out;
    return out;
  }
  SeatView seen;
  SeatWish wish;
  bool scripted = true;

 private:
  SeatDriver& script_;
};

class SeatAtARig : public PrivateNetworkTest {
 protected:
  void SetUp() override {
    PrivateNetworkTest::SetUp();
    if (IsSkipped()) return;
    script_.emplace(robot_.rig(), tour(robot_.rig(), 1, 30), HeadSway{});
    operator_.emplace(*script_);
    driver_.emplace(*operator_);
    line_ = std::make_shared<link::PretendedLine>(slow_line(), link::PretendedLine::Side::robot, robot_.clock());
    there_.emplace(LinkConfig{}, "robot", link::Role::robot, line_);
    here_.emplace(*there_, "operator");
    const Identity identity = link::rig_identity(robot_.rig(), source_folder() / "configs" / "minerva.yaml", "test");
    server_.emplace(*there_, robot_.rig(), robot_.robot(), nullptr, identity, robot_.clock(),
                    link::RobotServer::Start{});
    link::OperatorEndOptions options;
    options.seat.identity = identity;
    options.seat.draw = machine_nonces();
    options.frames = false;
    end_.emplace(*here_, options, robot_.clock());
    seat_.emplace(robot_.rig(), *end_, *driver_, robot_.clock());
    operator_->listen_to([this]() -> std::optional<link::RobotState> {
      const auto heard = end_->robot_state();
      return heard ? std::optional(heard->state) : std::nullopt;
    });
  }
  /// 8 ms of both sides; the operator's stands still where it is `frozen`.
  void tick(bool frozen = false) {
    robot_.run(8ms);
    const RobotTime now = robot_.clock().now();
    Commander* const commander = &server_->commander();
    serve(std::span(&commander, 1), robot_.robot(), now);
    server_->step(now);
    if (!line_is_dead_) line_->step();
    if (frozen) return;
    end_->step();
    seat_->step();
    if (const auto instant = seat_->instant_to_show()) seat_->show(instant);
  }
  void run(Duration time, bool frozen = false) {
    for (const RobotTime end = robot_.clock().now() + time; robot_.clock().now() < end;) tick(frozen);
  }
  bool until(const std::function<bool()>& what, Duration most) {
    for (const RobotTime end = robot_.clock().now() + most; robot_.clock().now() < end;) {
      tick();
      if (what()) return true;
    }
    return false;
  }
  bool follows() const { return driver_->seen.control.follows; }

  LiveRobot robot_{"minerva.yaml"};
  std::optional<ToolScript> script_;
  std::optional<ScriptedDriver> operator_;
  std::optional<ToldDriver> driver_;
  std::shared_ptr<link::PretendedLine> line_;
  bool line_is_dead_ = false;  ///< what is on it waits
  std::optional<link::Participant> there_, here_;
  std::optional<link::RobotServer> server_;
  std::optional<link::OperatorEnd> end_;
  std::optional<Seat> seat_;
};

// One that starts the robot over the line, drives, and is shown what the robot does when his commands get there.
TEST_F(SeatAtARig, StartsARobotDrivesItAndShowsItWhereItWillBe) {
  ASSERT_TRUE(until([this] { return follows(); }, 400s)) << seat_->status().control.words;
  double way = 0;
  for (int i = 0; i < 120; ++i) {
    const double before = robot_.shaft(1).position;
    run(100ms);
    way += std::abs(robot_.shaft(1).position - before);
  }
  EXPECT_GT(way, 0.2) << "rad: it hardly moved";
  EXPECT_TRUE(follows());
  EXPECT_EQ(operator_->state().losses, 0) << driver_->seen.control.words;
  const SeatStatus status = seat_->status();
  EXPECT_NEAR(status.delay.seconds, 0.065, 0.02);
  EXPECT_NE(status.shown.status, StateStatus::invalid) << to_words(status.shown, robot_.rig().joint_names());
  ASSERT_TRUE(status.outlook.error);
  EXPECT_LT(*status.outlook.error, 0.01) << "rad: what was shown for an instant against what encoders told of it";
  EXPECT_GT(status.outlook.scored, 200u);
}

// The operator's program stands still under a held switch: the robot stops, and what comes then moves nothing until the
// switch was let go of.
TEST_F(SeatAtARig, AfterALossNothingMovesBeforeTheSwitchIsPressedAnew) {
  ASSERT_TRUE(until([this] { return follows(); }, 400s)) << seat_->status().control.words;
  run(2s);
  driver_->scripted = false;  // the switch stays held, as it was
  ASSERT_TRUE(driver_->wish.deadman);
  run(1s, true);
  robot_.expect_at_rest("after a second without set-points");
  run(3s);
  EXPECT_FALSE(seat_->status().engaged);
  EXPECT_TRUE(seat_->status().held);
  robot_.expect_at_rest("while the switch of before is still held");
  ASSERT_TRUE(seat_->instant_to_show());
  EXPECT_LT(to_seconds(*seat_->instant_to_show() - robot_.clock().now()), 1) << "what is shown goes on with time";

  driver_->wish.deadman = false;
  run(1s);
  ASSERT_TRUE(driver_->seen.robot.ready) << driver_->seen.control.words;
  driver_->wish.position = driver_->seen.robot.begin;
  driver_->wish.deadman = true;
  EXPECT_TRUE(until([this] { return follows(); }, 2s)) << driver_->seen.control.words;
  EXPECT_TRUE(seat_->status().engaged);
}

// Then all that was under way comes at once, ten seconds old.
TEST_F(SeatAtARig, TenSecondsWithoutAnyStateAreInvalidAndMoveNothing) {
  ASSERT_TRUE(until([this] { return follows(); }, 400s)) << seat_->status().control.words;
  run(2s);
  ASSERT_EQ(seat_->status().shown.status, StateStatus::predicted);
  driver_->scripted = false;  // the switch stays held, as it was
  line_is_dead_ = true;
  run(10s);
  robot_.expect_at_rest("without a line");
  SeatStatus status = seat_->status();
  EXPECT_EQ(status.shown.status, StateStatus::invalid);
  EXPECT_EQ(status.shown.reason, FutureReason::stale);
  EXPECT_FALSE(status.engaged);
  EXPECT_TRUE(status.held);
  EXPECT_FALSE(status.control.words.empty());

  line_is_dead_ = false;
  const double before = robot_.shaft(1).position;
  run(3s);
  status = seat_->status();
  EXPECT_NE(status.shown.status, StateStatus::invalid) << "it is known again";
  EXPECT_FALSE(status.engaged) << "the switch of before does not count";
  robot_.expect_at_rest("while the switch of before is still held");
  EXPECT_NEAR(robot_.shaft(1).position, before, 1e-6);
}

// A picture that cannot be drawn: the robot hears that the switch is open, rather than no more of it.
TEST_F(SeatAtARig, WhoLeavesByAnExceptionLetsGoFirst) {
  ASSERT_TRUE(until([this] { return follows(); }, 400s)) << seat_->status().control.words;
  driver_->scripted = false;  // the switch stays held, as it was
  bool seat_runs = true;
  robot_.clock().every(8ms, [&](RobotTime now) {
    Commander* const commander = &server_->commander();
    serve(std::span(&commander, 1), robot_.robot(), now);
    server_->step(now);
    line_->step();
    end_->step();
    if (seat_runs) seat_->step();
  });
  try {
    const SeatEnd end(*seat_, robot_.clock());
    throw std::runtime_error("no picture");
  } catch (const std::runtime_error&) {
    seat_runs = false;
  }
  EXPECT_FALSE(seat_->status().held);
  robot_.run(150ms);  // a round trip
  EXPECT_EQ(seat_->status().robot_control.cause, RestCause::let_go);
}

}  // namespace
}  // namespace foresight::seat_test
