// The robot's end of the line in stepped time, and what comes out at a reader.
#include <opencv2/imgcodecs.hpp>

#include "link/dds/topics.hpp"
#include "link/robot_side/robot_server.hpp"
#include "tests/link/child.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::senders_test {
namespace {

using namespace std::chrono_literals;

/// A wall clock that says the same as `clock`.
WallClock same_as(const Clock& clock) {
  return WallClock(clock, [&clock] { return clock.now().ns; });
}

/// All that came, in order.
template <typename T>
std::vector<T> taken(Reader& reader) {
  std::vector<T> out;
  const std::size_t came = reader.take<T>({}, [&](T&& message, const Sample&) { out.push_back(std::move(message)); });
  EXPECT_EQ(out.size(), came) << "some were refused";
  return out;
}

class Senders : public PrivateNetworkTest {};

// Two seconds of a moving robot: 50 joint states a second, each true for its own stamp; a state at every change.
TEST_F(Senders, StatesComeAtTheirRateAndAtOnceWhenTheyChange) {
  LiveRobot robot("minerva.yaml");
  Participant program(LinkConfig{}, "test");
  WallClock wall = same_as(robot.clock());
  const auto names = robot.rig().joint_names();
  StateSender sender(program, {1, names}, robot.rig(), robot.robot(), nullptr, wall, robot.clock());
  const auto reader_of = [&](Topic topic) {
    topic.depth = 1000;
    return std::make_unique<Reader>(program, topic);
  };
  const auto joints = reader_of(topics::joint_states()), transforms = reader_of(topics::transforms()),
             states = reader_of(topics::robot_state()), set_points = reader_of(topics::set_points()),
             fixed = reader_of(topics::static_transforms());
  robot.get_moving();
  sender.step(robot.clock().now());  // what is due from before
  for (Reader* reader : {joints.get(), transforms.get(), states.get(), set_points.get()})
    reader->take([](const Sample&) {});

  std::map<std::int64_t, double> elbow;  // where it really was
  const std::size_t joint = robot.joint("elbow");
  for (int i = 0; i < 250; ++i) {  // 8 ms each
    robot.move(8ms);
    elbow[robot.clock().now().ns] = robot.shaft(joint).position;
    sender.step(robot.clock().now());
  }
  const auto came = taken<JointStateMessage>(*joints);
  EXPECT_NEAR(static_cast<double>(came.size()), 100, 2);
  for (const JointStateMessage& message : came) {
    ASSERT_EQ(message.name, names);
    const auto after = elbow.lower_bound(unix_ns(message.header.stamp));  // of the next 8 ms
    ASSERT_NE(after, elbow.end());
    EXPECT_NEAR(message.position[joint], after->second, 0.012);
  }
  EXPECT_EQ(taken<TFMessage>(*transforms).size(), came.size());
  EXPECT_EQ(taken<JointTrajectory>(*set_points).size(), came.size());
  EXPECT_EQ(taken<TFMessage>(*fixed).size(), 1u);

  const auto before = taken<RobotState>(*states);
  EXPECT_NEAR(static_cast<double>(before.size()), 20, 2);
  robot.robot().ask(RobotRequest::emergency_stop);
  robot.run(4ms);
  sender.step(robot.clock().now());
  const auto changed = taken<RobotState>(*states);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_EQ(changed[0].reason.label, "operator's stop");
  EXPECT_EQ(changed[0].number, before.back().number + 1);
}

// What a line carries is told by the sender of pictures; here it is simply said.
TEST_F(Senders, StatesLeaveAThinLineToThePictures) {
  LiveRobot robot("minerva.yaml");
  Participant program(LinkConfig{}, "test");
  WallClock wall = same_as(robot.clock());
  LineCapacity line;
  StateSender sender(program, {1, robot.rig().joint_names()}, robot.rig(), robot.robot(), nullptr, wall, robot.clock(),
                     nullptr, &line);
  Topic topic = topics::gate_motion();
  topic.depth = 1000;
  Reader motions(program, topic);
  robot.get_moving();
  const auto came_in_2s = [&](double bytes_per_s) {
    line.bytes_per_s = bytes_per_s;
    sender.step(robot.clock().now());
    motions.take([](const Sample&) {});
    for (int i = 0; i < 250; ++i) {
      robot.move(8ms);
      sender.step(robot.clock().now());
    }
    std::size_t bytes = 0, count = 0;
    motions.take([&](const Sample& sample) { bytes += sample.cdr.size(), ++count; });
    return std::pair(count, static_cast<double>(bytes));
  };
  EXPECT_NEAR(static_cast<double>(came_in_2s(0).first), 100, 2) << "nothing is known of the line";
  EXPECT_NEAR(static_cast<double>(came_in_2s(1e6).first), 100, 2) << "it carries plenty";
  const auto [count, bytes] = came_in_2s(50'000);
  EXPECT_LT(bytes, 0.12 * 2 * 50'000) << count;
  EXPECT_GT(bytes, 0.05 * 2 * 50'000) << count;
  EXPECT_GE(came_in_2s(1000).first, 9u) << "however thin, five times a second";
}

// --- pairs ----------------------------------------------------------------------------------------------------------

LiveFramePtr frame_at(std::uint64_t number, RobotTime time, int width = 64, int height = 48) {
  auto frame = std::make_shared<LiveFrame>();
  frame->number = number;
  frame->pair.left.time = frame->pair.right.time = time;
  frame->pair.left.bgr = cv::Mat(height, width, CV_8UC3, cv::Scalar::all(100));
  frame->pair.right.bgr = cv::Mat(height, width, CV_8UC3, cv::Scalar::all(200));
  PosedFrame posed;
  posed.left.T_world_camera = posed.right.emplace().T_world_camera = Pose::Identity();
  frame->posed = posed;
  return frame;
}

StereoLenses lenses() {
  const Lens lens(Lens::Parameters{LensModel::plumb_bob, 64, 48, 50, 50, 32, 24, {}});
  return {lens, lens, Pose::Identity()};
}

class FrameSenders : public Senders {
 protected:
  FrameSender sender(double rate_hz = 30, LinkCoding coding = LinkCoding::jpeg) {
    static const StereoLenses both = lenses();
    return {program_, {1, {}}, &both, queue_, {coding, 90, rate_hz}, wall_, clock_};
  }
  Reader reader(Topic topic) {
    topic.depth = 1000;
    return {program_, topic};
  }

  SteppedClock clock_;
  WallClock wall_ = same_as(clock_);
  std::shared_ptr<FrameQueue> queue_ = std::make_shared<FrameQueue>(2);
  Participant program_{LinkConfig{}, "test"};
};

TEST_F(FrameSenders, APairArrivesWholeWithItsCopies) {
  FrameSender to = sender();
  Reader frames = reader(topics::frames()), left = reader(topics::compressed_images("left")),
         right = reader(topics::compressed_images("right")), info = reader(topics::camera_info("left")),
         transforms = reader(topics::transforms());
  queue_->put(frame_at(3, RobotTime{5'000'000'000}));
  to.step(0ns);
  const auto pairs = taken<StereoFrame>(frames);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].number, 3u);
  EXPECT_EQ(pairs[0].coding, "jpeg");
  EXPECT_EQ(pairs[0].left.capture_ns, 5'000'000'000);
  EXPECT_EQ(pairs[0].header.stamp.sec, 5);
  EXPECT_NE(pairs[0].lenses_revision, "");
  const cv::Mat picture = cv::imdecode(pairs[0].right.data, cv::IMREAD_COLOR);
  ASSERT_EQ(picture.size(), cv::Size(64, 48));
  EXPECT_NEAR(picture.at<cv::Vec3b>(20, 20)[1], 200, 2);
  const auto copies = taken<CompressedImage>(left);
  ASSERT_EQ(copies.size(), 1u);
  EXPECT_EQ(copies[0].data, pairs[0].left.data);
  EXPECT_EQ(copies[0].header.frame_id, "left_camera");
  EXPECT_EQ(taken<CompressedImage>(right).size(), 1u);
  EXPECT_EQ(taken<CameraInfoMessage>(info).at(0).width, 64u);
  EXPECT_EQ(taken<TFMessage>(transforms).at(0).transforms.size(), 2u);
}

// The operator's pairs go as pieces, to who reports; tools of others find what they always find.
TEST_F(FrameSenders, CodedPairsLeaveTheCopiesAsTheyAre) {
  FrameSender to = sender(30, LinkCoding::h264);
  Reader frames = reader(topics::frames()), left = reader(topics::compressed_images("left")),
         transforms = reader(topics::transforms()), pieces = reader(topics::pieces());
  const auto put = [&](std::uint64_t number) {
    queue_->put(frame_at(number, RobotTime{} + seconds(number)));
    to.step(0ns);
  };
  put(1);
  EXPECT_EQ(taken<CompressedImage>(left).size(), 1u);
  EXPECT_EQ(taken<TFMessage>(transforms).size(), 1u);
  EXPECT_TRUE(taken<StereoPiece>(pieces).empty()) << "nobody reports";
  EXPECT_FALSE(to.counts().watched);
  Writer reports(program_, topics::reports());
  reports.write(StereoReport{0, 9, 0, 0, 0, {}});
  put(2);
  put(3);
  EXPECT_TRUE(to.counts().watched);
  const auto came = taken<StereoPiece>(pieces);
  ASSERT_FALSE(came.empty());
  EXPECT_EQ(came[0].session, 1u);
  EXPECT_EQ(came[0].reader, 9u);
  EXPECT_TRUE(taken<StereoFrame>(frames).empty());
  EXPECT_EQ(frames.writers(), 0u);
}

TEST_F(FrameSenders, SendsAtMostItsRateAndAlwaysTheNewest) {
  FrameSender to = sender(/*rate_hz=*/15);
  Reader frames = reader(topics::frames());
  for (std::uint64_t i = 0; i < 60; ++i) {  // 30 a second
    queue_->put(frame_at(i + 1, RobotTime{} + seconds(static_cast<double>(i) / 30)));
    to.step(0ns);
  }
  EXPECT_EQ(taken<StereoFrame>(frames).size(), 30u);
  for (const std::uint64_t i : {100, 101, 102, 103}) queue_->put(frame_at(i, RobotTime{} + seconds(i)));
  to.step(0ns);
  const auto last = taken<StereoFrame>(frames);
  ASSERT_EQ(last.size(), 1u);
  EXPECT_EQ(last[0].number, 103u);
}

TEST_F(FrameSenders, APairThatCannotBeCodedIsCountedAndTheNextOneGoes) {
  FrameSender to = sender();
  Reader frames = reader(topics::frames());
  auto empty = std::make_shared<LiveFrame>(*frame_at(1, RobotTime{1'000'000'000}));
  empty->pair.right.bgr.release();
  queue_->put(empty);
  to.step(0ns);
  queue_->put(frame_at(2, RobotTime{2'000'000'000}));
  to.step(0ns);
  EXPECT_EQ(to.counts().failed, 1u);
  EXPECT_EQ(to.counts().sent, 1u);
  EXPECT_EQ(taken<StereoFrame>(frames).at(0).number, 2u);
}

// A program that stands still while it reads pairs and states, and one that takes nothing: every step of both senders
// sends, and the robot goes on as if they were not there.
TEST_F(Senders, AReaderThatStopsHoldsUpNeitherRobotNorPairs) {
  const auto never_takes = [] {
    Participant program(LinkConfig{}, "slow");
    Reader frames(program, topics::frames()), states(program, topics::robot_state()),
        joints(program, topics::joint_states());
    for (;;) ::pause();
  };
  const Child slow(never_takes), stopped(never_takes);
  LiveRobot robot("minerva.yaml");
  Participant program(LinkConfig{}, "robot");
  WallClock wall = same_as(robot.clock());
  const auto queue = std::make_shared<FrameQueue>(2);
  cv::Mat noise(384, 512, CV_8UC3);  // some 300 kB each, as a large picture has
  cv::theRNG().fill(noise, cv::RNG::UNIFORM, 0, 255);
  StateSender states(program, {1, robot.rig().joint_names()}, robot.rig(), robot.robot(), nullptr, wall, robot.clock());
  FrameSender pairs(program, {1, robot.rig().joint_names()}, nullptr, queue, {LinkCoding::jpeg, 95, 30}, wall,
                    robot.clock());
  Writer probe(program, topics::frames());
  ASSERT_TRUE(comes_true([&] { return probe.readers() == 2; }));
  stopped.pause();
  Reader good(program, topics::frames());
  robot.get_moving();
  std::uint64_t newest = 0;
  for (std::uint64_t i = 1; i <= 90; ++i) {  // three seconds
    robot.move(32ms);
    auto large = std::make_shared<LiveFrame>(*frame_at(i, robot.clock().now()));
    large->pair.left.bgr = large->pair.right.bgr = noise;
    queue->put(large);
    pairs.step(0ns);
    states.step(robot.clock().now());
    for (const StereoFrame& frame : taken<StereoFrame>(good)) newest = frame.number;
    ASSERT_EQ(newest, i);
  }
  EXPECT_EQ(pairs.counts().sent, 90u);
  EXPECT_GT(pairs.counts().bytes, 90 * 300'000u);
  EXPECT_EQ(robot.robot().status().gate.state, GateState::following);
  robot.expect_limits_kept("while a reader stands still");
}

}  // namespace
}  // namespace foresight::link::senders_test
