// A served mock rig and an operator's end in one process, over DDS on loopback, in stepped time: frames of either
// coding, as a display takes them, against those that were sent.
#include "common/error.hpp"
#include "link/control_wire/control_wire.hpp"
#include "link/dds/topics.hpp"
#include "link/operator_view/line_feed.hpp"
#include "link/robot_side/frame_sender.hpp"
#include "link/robot_side/rig_identity.hpp"
#include "link/robot_side/served_operator.hpp"
#include "link/robot_side/state_sender.hpp"
#include "session/encoder_poses.hpp"
#include "sim/pan_tilt_head.hpp"
#include "sim/synth_run.hpp"
#include "tests/control/small_line.hpp"
#include "tests/link/child.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/moving_picture.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::two_ends_test {
namespace {

using namespace std::chrono_literals;

const cv::Size kSize{160, 120};

StereoLenses small_lenses() {
  sim::SynthOptions small;
  small.width = kSize.width, small.height = kSize.height;
  return {sim::synth_lens(small, false), sim::synth_lens(small, true), sim::T_head_left_right()};
}

class TwoEnds : public PrivateNetworkTest {
 protected:
  void SetUp() override {
    PrivateNetworkTest::SetUp();
    if (IsSkipped()) return;
    robot_.get_moving();
  }
  void serve(LinkCoding coding) {
    sender_.emplace(program_, SenderName{42, robot_.rig().joint_names()}, &lenses_, frames_.subscribe(2),
                    FrameSenderOptions{coding, 90, 30}, wall_, robot_.clock());
  }
  ControlDeskOptions desk_options() {
    ControlDeskOptions out;
    out.identity = identity_;
    out.draw = counting(1000);
    return out;
  }
  OperatorEndOptions operator_options() {
    OperatorEndOptions out;
    out.seat.identity = identity_;
    out.seat.draw = counting(1'000'000);
    out.expected = {{}, robot_.rig().joint_names(), {{160, 120, 160, 120}}};
    out.asleep = [this] { return asleep_; };
    return out;
  }
  /// 8 ms of both sides; a pair every 40 ms.
  void tick() {
    robot_.move(8ms);
    const RobotTime now = robot_.clock().now();
    if (++ticks_ % 5 == 0) {
      const StereoPicture picture = moving_picture(now, kSize);
      frames_.add({{picture.left, 0, now, 1us}, {picture.right, 0, now, 1us}});
    }
    frames_.step();
    while (const auto frame = sent_->take(0ns)) sent_frames_[(*frame)->number] = *frame;
    sender_->step(0ns);
    states_.step(now);
    Commander* const commander = &served_;
    foresight::serve(std::span(&commander, 1), robot_.robot(), now);
    end_.step();
  }
  void run(int ticks, LiveSource& source) {
    for (int i = 0; i < ticks; ++i) {
      tick();
      while (source.advance() == SourceState::ready) {
        if (const auto frame = source.arrived()) shown_.emplace_back(number_of(frame->left.time), *frame);
      }
    }
  }
  /// 8 ms of both sides, the operator's commanding where it holds the lease, unless its program stands still.
  void drive(const LinePositions& positions, bool deadman, bool stands_still = false) {
    robot_.run(8ms);
    const RobotTime now = robot_.clock().now();
    states_.step(now);
    Commander* const commander = &served_;
    foresight::serve(std::span(&commander, 1), robot_.robot(), now);
    if (stands_still) return;
    end_.seat([&](ControlSeat& seat, OperatorTime here) {
      if (seat.status(here).phase == ControlSeatStatus::Phase::holding) seat.command(here, positions, deadman);
    });
    end_.step();
  }
  ControlState told() {
    return end_.seat([](ControlSeat& seat, OperatorTime) { return seat.state(); });
  }
  ControlSeatStatus seat_status() {
    return end_.seat([](ControlSeat& seat, OperatorTime now) { return seat.status(now); });
  }
  /// Until the robot is ready for a press, and the open switch was seen. Where set-points begin then.
  LinePositions get_ready() {
    for (int i = 0; i < 500 && !(told().ready && seat_status().phase == ControlSeatStatus::Phase::holding); ++i)
      drive({}, false);
    EXPECT_TRUE(told().ready) << seat_status().words;
    for (int i = 0; i < 5; ++i) drive(told().begin, false);
    return told().begin;
  }
  /// The elbow goes by 0.2 rad in a second; what was commanded last.
  LinePositions swing() {
    LinePositions positions = get_ready();
    for (int i = 0; i < 125; ++i) {
      drive(positions, true);
      positions[robot_.joint("elbow")] += 0.0016;
    }
    EXPECT_EQ(robot_.robot().status().gate.state, GateState::following) << seat_status().words;
    return positions;
  }
  /// Its program goes on with what it had under way, farther, and the switch held: nothing moves until it is let go of.
  void expect_no_motion_before_another_press(LinePositions positions) {
    robot_.expect_at_rest("when the operator's program goes on");
    const std::size_t elbow = robot_.joint("elbow");
    const double rest = robot_.shaft(elbow).position;
    positions[elbow] += 0.3;
    for (int i = 0; i < 400; ++i) {  // long enough for the lease to be there again
      drive(positions, true);
      ASSERT_NE(robot_.robot().status().gate.state, GateState::following) << i;
    }
    EXPECT_NEAR(robot_.shaft(elbow).position, rest, 1e-4);
    EXPECT_TRUE(seat_status().must_let_go) << seat_status().words;
    swing();
    robot_.expect_limits_kept("all the while");
  }
  std::uint64_t number_of(RobotTime time) const {
    for (const auto& [number, frame] : sent_frames_)
      if (frame->pair.left.time == time) return number;
    return 0;
  }
  /// What a display got is what the robot's own display would get, but for the coding of the pixels.
  void expect_same(double psnr_db) const {
    for (const auto& [number, frame] : shown_) {
      const auto sent = sent_frames_.find(number);
      ASSERT_NE(sent, sent_frames_.end()) << "an instant that no pair was taken at";
      ASSERT_TRUE(sent->second->posed && frame.right);
      const PosedFrame& truth = *sent->second->posed;
      for (const auto& [got, wanted] : {std::pair(&frame.left, &truth.left), std::pair(&*frame.right, &*truth.right)}) {
        EXPECT_EQ(got->time, wanted->time);
        EXPECT_TRUE(got->T_world_camera.isApprox(wanted->T_world_camera, 1e-12));
        EXPECT_EQ(got->scene.time, wanted->scene.time);
        EXPECT_EQ(got->scene.status, wanted->scene.status);
        ASSERT_EQ(got->scene.T_world_node.size(), wanted->scene.T_world_node.size());
        for (std::size_t i = 0; i < got->scene.T_world_node.size(); ++i)
          EXPECT_TRUE(got->scene.T_world_node[i].isApprox(wanted->scene.T_world_node[i], 1e-12));
        EXPECT_EQ(got->margin_px, wanted->margin_px);
        EXPECT_GT(cv::PSNR(got->pixels, wanted->pixels), psnr_db);
      }
    }
  }

  Duration asleep_{0};  // the operator's host
  LiveRobot robot_{"minerva.yaml"};
  Identity identity_ = rig_identity(robot_.rig(), source_folder() / "configs" / "minerva.yaml", "test");
  StereoLenses lenses_ = small_lenses();
  std::shared_ptr<const LiveScene> scene_ = std::make_shared<const LiveScene>(
      std::make_shared<const sim::LiveLab>(sim::LiveLab::Options{.texel = 0.02}), lenses_);
  Participant program_{LinkConfig{}, "test"};
  WallClock wall_{robot_.clock(), [this] { return robot_.clock().now().ns; }};
  LiveFrames frames_{std::make_shared<EncoderPoses>(robot_.rig(), scene_, robot_.robot().cycles()), robot_.clock()};
  std::shared_ptr<FrameQueue> sent_ = frames_.subscribe(100);
  std::optional<FrameSender> sender_;
  StateSender states_{program_,      {42, robot_.rig().joint_names()}, robot_.rig(), robot_.robot(), nullptr, wall_,
                      robot_.clock()};
  ServedOperator served_{program_, robot_.rig().gate_options(), desk_options(), robot_.clock()};
  OperatorEnd end_{program_, operator_options(), robot_.clock()};
  std::map<std::uint64_t, LiveFramePtr> sent_frames_;
  std::vector<std::pair<std::uint64_t, PosedFrame>> shown_;
  int ticks_ = 0;
};

TEST_F(TwoEnds, JpegPairsAreShownAsTheyWereSent) {
  serve(LinkCoding::jpeg);
  LiveSource source(line_feed(end_, robot_.rig(), scene_), robot_.clock(), {.real_time = false});
  run(250, source);  // two seconds
  EXPECT_GE(shown_.size(), 45u);
  expect_same(32);
  const LineFigures figures = end_.figures();
  EXPECT_EQ(figures.coding, "jpeg");
  EXPECT_NEAR(figures.pairs_per_s, static_cast<double>(shown_.size()) / 2, 3);
  EXPECT_EQ(figures.pairs.refused, 0u) << figures.pairs.refusal;
  EXPECT_EQ(source.fault(), "");
}

TEST_F(TwoEnds, CodedPairsAreShownAsTheyWereSent) {
  serve(LinkCoding::h264);
  LiveSource source(line_feed(end_, robot_.rig(), scene_), robot_.clock(), {.real_time = false});
  run(250, source);
  EXPECT_GE(shown_.size(), 25u);
  expect_same(26);
  const LineFigures figures = end_.figures();
  EXPECT_EQ(figures.coding, "h264");
  EXPECT_EQ(figures.pairs.refused, 0u) << figures.pairs.refusal;
  EXPECT_EQ(figures.pairs.packets, figures.pairs.expected);
  EXPECT_EQ(sender_->counts().failed, 0u);
}

TEST_F(TwoEnds, ClocksStatesAndControlComeAlong) {
  serve(LinkCoding::jpeg);
  LiveSource source(line_feed(end_, robot_.rig(), scene_), robot_.clock(), {.real_time = false});
  run(150, source);
  const LineFigures figures = end_.figures();
  ASSERT_TRUE(figures.clock && figures.round_trip);
  EXPECT_LE(figures.clock->least, 0) << "it is the same clock";
  EXPECT_GE(figures.clock->most, 0);
  EXPECT_LE(*figures.round_trip, Duration(20ms));
  ASSERT_FALSE(figures.ages.empty());
  EXPECT_LE(std::abs(figures.ages.back().delay.count()), (figures.ages.back().uncertainty + 20ms).count());
  const auto state = end_.robot_state();
  ASSERT_TRUE(state && state->time);
  EXPECT_EQ(state->state.rig, "minerva");
  EXPECT_LE(state->time->earliest(), OperatorTime{robot_.clock().now().ns});
  end_.seat([&](ControlSeat& seat, OperatorTime now) {
    EXPECT_EQ(seat.status(now).phase, ControlSeatStatus::Phase::connected);
    EXPECT_EQ(seat.state().joints, robot_.rig().joints.size());
    const std::size_t elbow = robot_.joint("elbow");
    EXPECT_NEAR(seat.state().measured[elbow], robot_.shaft(elbow).position, 0.05);
  });
}

TEST_F(TwoEnds, MessagesThatCannotBeAreToldWithTopicAndField) {
  serve(LinkCoding::jpeg);
  const auto told = [this](const Topic& topic, const Bytes& bytes) {
    Writer stranger(program_, topic);
    stranger.write(bytes);
    end_.step();
    return end_.figures().refusal;
  };
  const Bytes none{0, 1, 0, 0, 9};
  EXPECT_EQ(told(topics::frames(), none), "rt/foresight/frames: bytes are no such message");
  EXPECT_EQ(told(topics::pieces(), none), "rt/foresight/pieces: bytes are no such message");
  EXPECT_EQ(told(topics::robot_state(), none), "rt/foresight/robot_state: bytes are no such message");
  EXPECT_EQ(told({"rt/foresight/control/robot/messages", kFromRobotType, Delivery::newest, 64}, none),
            "rt/foresight/control/robot/messages: bytes are no such message");
  GateMotion motion;
  motion.joints.resize(robot_.rig().joints.size());
  motion.joints[3].position = NAN;
  EXPECT_EQ(told(topics::gate_motion(), to_cdr(motion)), "rt/foresight/gate_motion: joints[3].position is nan");
  EXPECT_EQ(end_.figures().refused, 5u);
}

TEST(WhyNoImages, IsWhatTheRobotToldOrWhatCameShows) {
  LineFigures figures;
  std::optional<OperatorEnd::HeardState> heard;
  std::optional<Duration> control_age = 200ms;
  const auto why = [&] { return why_no_images(figures, heard, control_age); };
  EXPECT_EQ(why(), "nothing is heard of the robot");
  heard.emplace();
  EXPECT_EQ(why(), "its program runs without cameras");
  heard->state.cameras.present = true;
  EXPECT_EQ(why(), "the robot is heard, and none come");
  figures.pairs.refusal = "the left image is 400x300";
  EXPECT_EQ(why(), "the robot is heard, and none come") << "good ones have come since";
  figures.pairs.refuses = true;
  EXPECT_EQ(why(), "the last that came were refused: the left image is 400x300");
  heard->state.cameras.fault = "the left camera is gone";
  EXPECT_EQ(why(), "the left camera is gone");
  control_age = 600ms;
  EXPECT_EQ(why(), "nothing is heard of the robot");
}

// A reader of pieces that takes nothing, in a program that stands still: pairs go on to the one who reports.
TEST_F(TwoEnds, AReaderOfPiecesThatStopsHoldsUpNobody) {
  serve(LinkCoding::h264);
  Reader never_takes(program_, topics::pieces());
  LiveSource source(line_feed(end_, robot_.rig(), scene_), robot_.clock(), {.real_time = false});
  run(250, source);
  EXPECT_GE(shown_.size(), 25u);
  EXPECT_EQ(robot_.robot().status().gate.state, GateState::following);
  robot_.expect_limits_kept("while a reader takes nothing");
}

/// An operator's end that commands, in place of who moved the robot so far.
class Driven : public TwoEnds {
 protected:
  void SetUp() override {
    TwoEnds::SetUp();
    if (IsSkipped()) return;
    robot_.robot().submit(robot_.command(false));
    robot_.run(2s);
    end_.seat([](ControlSeat& seat, OperatorTime) { seat.want_control(true); });
  }
};

// Stopped by a signal or a debugger, or its host swaps: time goes on, and set-points expire.
TEST_F(Driven, AfterTheOperatorsProgramStoodStillNothingMovesWithoutAnotherPress) {
  const LinePositions positions = swing();
  for (int i = 0; i < 625; ++i) {  // 5 s
    drive({}, true, /*stands_still=*/true);
    if (i > 125) robot_.expect_at_rest("a second after the last word");
  }
  expect_no_motion_before_another_press(positions);
}

// Its host was suspended: its own clock stood still meanwhile, and what it had under way looks fresh to it.
TEST_F(Driven, AfterTheOperatorsHostWasSuspendedNothingMovesWithoutAnotherPress) {
  LinePositions positions = swing();
  asleep_ += 5s;
  for (int i = 0; i < 125; ++i) drive(positions, true);
  expect_no_motion_before_another_press(positions);
}

// --- in real time ---------------------------------------------------------------------------------------------------

/// A robot's pairs without a robot, each side in its own threads.
class Threads : public PrivateNetworkTest, public testing::WithParamInterface<LinkCoding> {};

TEST_P(Threads, CarryPairsOfEitherCoding) {
  MonotonicClock clock;
  WallClock wall(clock);
  Participant program(LinkConfig{}, "test");
  const auto queue = std::make_shared<FrameQueue>(2);
  FrameSender sender(program, {42, {}}, nullptr, queue, {GetParam(), 90, 1000}, wall, clock);
  OperatorEndOptions options;
  options.seat.draw = counting(1000);
  OperatorEnd end(program, options, clock);
  sender.start();
  end.start();
  std::uint64_t number = 0, newest = 0;
  int came = 0;
  EXPECT_TRUE(comes_true([&] {
    auto frame = std::make_shared<LiveFrame>();
    frame->number = ++number;
    const StereoPicture picture = moving_picture(clock.now(), kSize);
    frame->pair = {{picture.left, 0, picture.captured, 1us}, {picture.right, 0, picture.captured, 1us}};
    queue->put(frame);
    while (const auto got = end.frames().take_newest(0ns)) {
      EXPECT_GT((*got)->number, newest);
      newest = (*got)->number;
      EXPECT_FALSE((*got)->image[0].T_world_camera) << "nobody knew it";
      ++came;
    }
    end.seat([](ControlSeat& seat, OperatorTime now) { return seat.status(now).phase; });
    return came >= 10;
  })) << end.figures().pairs.refusal;
  EXPECT_EQ(end.figures().pairs.refused, 0u) << end.figures().pairs.refusal;
  end.stop();
  sender.stop();
  EXPECT_TRUE(end.frames().closed());
}

INSTANTIATE_TEST_SUITE_P(Either, Threads, testing::Values(LinkCoding::jpeg, LinkCoding::h264));

TEST_F(TwoEnds, AnObserversKeysAreNoOperators) {
  const TempFolder folder;
  make_keys(folder / "keys", 1);
  LinkConfig config;
  config.domain = 7;
  config.security = folder / "keys";
  {
    Participant observer(config, "observer", Role::observer);
    EXPECT_THROW(OperatorEnd(observer, operator_options(), robot_.clock()), RuntimeFailure);
  }
  Participant operating(config, "operator", Role::operating);
  EXPECT_NO_THROW(OperatorEnd(operating, operator_options(), robot_.clock()));
}

}  // namespace
}  // namespace foresight::link::two_ends_test
